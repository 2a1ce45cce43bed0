"""Commands that stop the arm before they are recorded: whatever comes of the command, a locked guard is a held case."""

from service.conductor.answers import CommandAnswer
from service.conductor.caller import Caller
from service.conductor.conductor import LOCKED, Conductor
from service.conductor.taking import Prepare, Prepared, Taken
from service.errors import ServiceError
from workflow.facts import Stopped
from workflow.triggers import Trigger


def perform_stopped(
    conductor: Conductor, caller: Caller, trigger: Trigger, prepare: Prepare, reason: str
) -> CommandAnswer:
    """As `Conductor.perform`, the arm stopped first.

    A motion may end between the look that found it and the stop, which then locks a guard whose case moves no more and
    need not be held by the command, or the command is refused: such a case is held as by whoever presses stop.
    """
    conductor.bridge.stop_to_record()
    try:
        conductor.bridge.stop(reason)
        try:
            answer = conductor.perform(caller, trigger, prepare)
        except ServiceError:
            _hold_as_guard(conductor, caller, trigger)
            raise
        held = _hold_as_guard(conductor, caller, trigger)
        return answer if held is None else _newer(answer, held)
    finally:
        conductor.bridge.stop_recorded()


def _hold_as_guard(conductor: Conductor, caller: Caller, trigger: Trigger) -> Taken | None:
    """The room's open case, whichever was spoken of, held; None where it is locked already, or there is none."""
    case_id = conductor.open_case()
    if case_id is None or conductor.case_of(case_id).state in LOCKED:
        return None
    user_id = caller.session.user_id
    prepared = Prepared(Stopped(user_id), data={"sent_for": trigger})
    return conductor.observe(case_id, Trigger.STOP, lambda _: prepared, user_id)


def _newer(answer: CommandAnswer, held: Taken) -> CommandAnswer:
    if held.event.case_id != answer.case_id:
        return answer
    newer = {"state": held.decision.after.state, "version": held.event.version, "sequence": held.event.sequence}
    return answer.model_copy(update=newer)
