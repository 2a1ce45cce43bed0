"""Takes commands and observations: decide and record in one transaction, then touch the world."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Annotated
from uuid import uuid4

import structlog
from fastapi import Depends
from sqlalchemy.engine import Connection
from starlette.requests import HTTPConnection

from robot.errors import GuardDownError
from service.auth.lease import check_lease
from service.cases import store
from service.cases.idempotency import KeptAnswer, keep_answer, kept_answer
from service.conductor.answering import answer_of, error_of, record_failed_attempt
from service.conductor.answers import CommandAnswer
from service.conductor.begun_checks import BegunChecks
from service.conductor.caller import Caller
from service.conductor.echoes import Echoes
from service.conductor.handedness import ProvedConnections
from service.conductor.limits import limits_from
from service.conductor.taking import Prepare, Rules, Taken, case_here, stand, take
from service.database.free_space import check_free_space
from service.elapsed import elapsed_s
from service.errors import ServiceError
from service.motion.bridge import ArmBridge
from service.operations.counts import count_decision
from service.parts import Parts
from workflow.case import CaseState
from workflow.case_json import from_json
from workflow.decisions import Decision, Effect
from workflow.facts import Facts
from workflow.machine import decide
from workflow.refusals import Refusal
from workflow.states import INSERTION, OVER, State
from workflow.triggers import Trigger

_log = structlog.get_logger(__name__)

# The control lease is needed to aim and to move, not to look, to state or to stop.
LEASED = frozenset(
    {
        Trigger.TARGET_CONFIRMED,
        Trigger.TARGET_WITHDRAWN,
        Trigger.PLAN_REQUESTED,
        Trigger.MOVE_APPROVED,
        Trigger.MOVE_STARTED,
        Trigger.CORRECTION_REQUESTED,
        Trigger.INSERTION_STARTED,
    }
)
# The guard refuses every motion in these states, whatever anybody sends it.
LOCKED = INSERTION | OVER | {State.SAFE_HOLD}


def new_id() -> str:
    """An id for something that is about to be made."""
    return uuid4().hex


class Conductor:
    """Everything between a command and the outside world; its methods block: call them from a thread."""

    def __init__(self, parts: Parts, bridge: ArmBridge, clock: Callable[[], float] = elapsed_s) -> None:
        self.parts = parts
        self.bridge = bridge
        settings = parts.settings
        limits = limits_from(settings.limits)
        self.rules = Rules(bridge.watch, limits, clock, settings.fingerprint(), settings.room)
        self.echoes = Echoes()
        self.proved = ProvedConnections()
        self.daily_checks = BegunChecks()
        self.on_effect: dict[Effect, Callable[[Taken], None]] = {}
        self._live: Taken | None = None
        self._unlocking = threading.Lock()

    @property
    def journal_folder(self) -> Path:
        """Where the guard writes its journal."""
        return self.parts.settings.data_folder / "guard"

    @property
    def live(self) -> CaseState | None:
        """The open case as of the newest decision of this run, for what must not wait for the database."""
        live = self._live
        return None if live is None or live.decision.after.state in OVER else live.decision.after

    def perform(self, caller: Caller, trigger: Trigger, prepare: Prepare) -> CommandAnswer:
        """Take a person's request or fact; ServiceError with every verdict where it is refused."""
        try:
            # H24; what a person states is worth trying even on a full disk
            if caller.version is not None or trigger is Trigger.MOVE_STARTED:
                check_free_space(self.parts.settings.data_folder, self.parts.settings.min_free_bytes)
            with self.parts.database.write() as connection:
                result = self._take_once(connection, caller, trigger, prepare)
        except ServiceError as error:
            record_failed_attempt(self.parts.database, caller, trigger, error)
            raise
        if isinstance(result, CommandAnswer):
            return result
        if isinstance(result, Refusal):
            count_decision(trigger, result.code, result.verdicts)
            raise error_of(result)
        self._follow(result)
        return answer_of(result)

    def observe(self, case_id: str, trigger: Trigger, prepare: Prepare, user_id: str | None = None) -> Taken:
        """Record what was observed; it is never refused."""
        with self.parts.database.write() as connection:
            standing = stand(connection, self.rules, case_id, trigger)
            taken = take(standing, self.rules, trigger, prepare(standing), user_id, None)
        if isinstance(taken, Refusal):
            raise AssertionError(f"the observation {trigger} was refused: {taken.code}")
        self._follow(taken)
        return taken

    def open_case(self) -> str | None:
        """Id of the room's open case."""
        with self.parts.database.read() as connection:
            return store.open_case_of(connection, self.parts.settings.room)

    def case_of(self, case_id: str) -> CaseState:
        """A case as it stands; ServiceError CASE_UNKNOWN."""
        with self.parts.database.read() as connection:
            return from_json(dict(store.newest_event(connection, case_id).case_state))

    def unlock(self) -> bool:
        """Let the guard take motions again, unless the live case is locked: a hold may be newer than what allowed it.

        False where the guard was to be unlocked and did not take it: a fault is told that holds the case.

        A stop that becomes live after this look is sent to the guard after the unlocking, and locks it again.
        """
        with self._unlocking:
            live = self._live
            locked = live is None or live.decision.after.state in LOCKED
            return locked or self.bridge.unlock()

    def would_stop(self, case_id: str, trigger: Trigger, facts: Facts) -> bool:
        """Whether a fact stops the arm, so that the stop can be sent before anything is recorded."""
        if self.bridge.is_moving():
            return True
        with self.parts.database.read() as connection:
            _, last = case_here(connection, self.rules, case_id)
        case = from_json(dict(last.case_state))
        decision = decide(case, trigger, facts, None, self.rules.limits, self.rules.clock())
        return isinstance(decision, Decision) and Effect.STOP_SENT in decision.effects

    def _take_once(
        self, connection: Connection, caller: Caller, trigger: Trigger, prepare: Prepare
    ) -> CommandAnswer | Taken | Refusal:
        kept = kept_answer(connection, caller.intent) if caller.intent else None
        if kept is not None:
            return CommandAnswer(**kept.body)
        standing = stand(connection, self.rules, caller.case_id, trigger)
        if trigger in LEASED:
            check_lease(standing.lease, caller.session, caller.control_token)
        taken = take(standing, self.rules, trigger, prepare(standing), caller.session.user_id, caller.version)
        if isinstance(taken, Taken) and caller.intent:
            answer = answer_of(taken)
            keep_answer(connection, caller.intent, KeptAnswer(200, answer.model_dump(mode="json"), answer.version))
        return taken

    def _follow(self, taken: Taken) -> None:
        """After the commit: lock or unlock the guard with the state, then whatever the decision causes.

        Raises ServiceError guard_down, once all is done, where the guard was not unlocked.
        """
        decision, after = taken.decision, taken.decision.after
        count_decision(decision.trigger, decision.outcome, decision.verdicts)
        was_locked, is_locked = taken.before.state in LOCKED, after.state in LOCKED
        with self._unlocking:
            if self._live is None or _is_newer(taken, self._live):
                self._live = taken
                if is_locked and not was_locked:
                    self.bridge.stop(f"recorded: {decision.trigger}")  # a pause, too, locks the guard as a stop does
        unlocked = is_locked or not was_locked or self.unlock()
        if taken.prepared.then is not None:
            taken.prepared.then(decision)
        for effect in decision.effects:
            if effect in self.on_effect:
                self.on_effect[effect](taken)
        _log.info("recorded", trigger=decision.trigger, case_id=after.case_id, state=after.state, row=decision.row)
        if not unlocked:
            raise ServiceError(GuardDownError.code, "this is recorded, but the guard did not take it: the case is held")


def _is_newer(taken: Taken, live: Taken) -> bool:
    """Of two decisions the one that the room is in; a note on a case that is over is not."""
    if taken.event.case_id == live.event.case_id:
        return taken.event.sequence > live.event.sequence
    return taken.decision.after.state not in OVER


async def conductor_of(connection: HTTPConnection) -> Conductor:
    """The conductor of the service that this request came to."""
    conductor: Conductor = connection.app.state.conductor
    return conductor


TheConductor = Annotated[Conductor, Depends(conductor_of)]
