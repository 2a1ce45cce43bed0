"""From a decision to what the caller gets, and to what is remembered of a request that never reached the rules."""

import structlog

from service.cases import store
from service.cases.attempts import record_attempt
from service.cases.records import NewAttempt
from service.conductor.answers import CommandAnswer, VerdictAnswer
from service.conductor.caller import Caller
from service.conductor.taking import Taken
from service.conductor.verdict_json import kept_verdict, verdict_json
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from workflow.refusals import Refusal, RefusalCode
from workflow.triggers import Trigger

_log = structlog.get_logger(__name__)


def answer_of(taken: Taken) -> CommandAnswer:
    """What a command did."""
    decision = taken.decision
    return CommandAnswer(
        case_id=taken.event.case_id,
        trigger=decision.trigger,
        taken_as=decision.taken_as,
        outcome=decision.outcome,
        state=decision.after.state,
        version=taken.event.version,
        sequence=taken.event.sequence,
        made=dict(taken.prepared.made),
        voided=list(decision.voided),
        verdicts=[VerdictAnswer(**verdict_json(verdict)) for verdict in decision.verdicts],
        detail=dict(taken.prepared.detail),
    )


def error_of(refusal: Refusal) -> ServiceError:
    """A refusal of the rules as the caller sees it, with all verdicts.

    What the first interlock measured stands beside it only where interlocks refused: of a case that is held, or of a
    link of the chain that is missing, it says nothing.
    """
    first = next(iter(refusal.failed), None) if refusal.code is RefusalCode.INTERLOCK else None
    _log.warning("command_refused", trigger=refusal.trigger, state=refusal.state, code=refusal.code)
    return ServiceError(
        refusal.code,
        refusal.message,
        measured=first.measured if first else None,
        limit=first.limit if first else None,
        leads_onwards=refusal.leads_onwards,
        verdicts=[verdict_json(verdict) for verdict in refusal.verdicts],
    )


def record_failed_attempt(database: Database, caller: Caller, trigger: Trigger, error: ServiceError) -> None:
    """A stale version, a lost lease, a path that is not there: attempts too, with what was said."""
    _log.warning("command_refused", case_id=caller.case_id, trigger=trigger, code=error.code)
    try:
        with database.write() as connection:
            case_id, state = _known(database, caller.case_id)
            user_id, code, message = caller.session.user_id, error.code, error.message
            verdicts = tuple(map(kept_verdict, error.verdicts))
            record_attempt(connection, NewAttempt(case_id, user_id, trigger, False, code, message, state, verdicts))
    except ServiceError as fault:
        _log.error("attempt_not_recorded", case_id=caller.case_id, trigger=trigger, code=fault.code)


def _known(database: Database, case_id: str) -> tuple[str | None, str | None]:
    """The case and its state, if there is such a case: a row may not name one that there is not."""
    try:
        with database.read() as connection:
            return case_id, store.newest_event(connection, case_id).state
    except ServiceError as error:
        if error.code != ErrorCode.CASE_UNKNOWN:
            raise
        return None, None
