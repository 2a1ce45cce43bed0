"""Turns what the guard says into observations of the open case, one after the other, each until it is recorded."""

import asyncio
import math
import time
from typing import Any, assert_never

import structlog

from robot.guard.messages import (
    Disturbed,
    Event,
    Fault,
    FaultKind,
    MotionEnded,
    MotionStarted,
    MoveRefused,
    PendantReleased,
    Status,
    StopSent,
)
from robot.refusal import RefusalCode
from service.audit import record_audit
from service.cases import store
from service.cases.records import ArtefactKind, StoredArtefact
from service.conductor.conductor import Conductor
from service.conductor.taking import Prepared, Taken
from service.errors import ErrorCode, ServiceError, answer_for
from service.motion.endings import Ending, Endings
from service.motion.insertion_watch import drift_decides
from service.motion.outcomes import fault_of, outcome_of
from service.motion.trajectories import ending, motion_artefact
from workflow.facts import Facts, Movement, Stopped
from workflow.facts import MotionEnded as MotionOver
from workflow.triggers import Trigger

_log = structlog.get_logger(__name__)
_AGAIN_S = 0.5
_STOP_RECORDED_WITHIN_S = 5.0


class MotionObserver:
    """Reads the events of the guard from a queue."""

    def __init__(self, conductor: Conductor, endings: Endings) -> None:
        self._conductor = conductor
        self._endings = endings
        self._events: asyncio.Queue[Event] = asyncio.Queue()
        self._loop = asyncio.get_running_loop()

    def take(self, event: Event) -> None:
        """Take an event in, from any thread."""
        self._loop.call_soon_threadsafe(self._events.put_nowait, event)

    async def run(self) -> None:
        """Record events until cancelled; an event that cannot be recorded is tried again, for it happened."""
        while True:
            event = await self._events.get()
            await self._record_at_last(event)

    async def _record_at_last(self, event: Event) -> None:
        while True:
            try:
                return await self._record(event)
            except ServiceError as error:
                _log.error("observation_not_recorded", event_type=type(event).__name__, code=error.code)
            except Exception:  # noqa: BLE001  a defect in one record must not keep the faults behind it out of all
                _log.exception("observation_lost", event_type=type(event).__name__)
                event = Fault(FaultKind.GUARD_LOST, time.monotonic(), f"a {type(event).__name__} was lost")
            await asyncio.sleep(_AGAIN_S)

    async def _record(self, event: Event) -> None:
        match event:
            case MotionEnded():
                await self._motion_ended(event)
            case MoveRefused():
                await self._move_refused(event)
            case Fault():
                await self._fault(event)
            case Disturbed():
                await self._disturbed(event)
            case MotionStarted() | StopSent() | PendantReleased() | Status():
                _log.info("guard_said", event_type=type(event).__name__)
            case _:
                assert_never(event)

    async def _motion_ended(self, event: MotionEnded) -> None:
        use = await asyncio.to_thread(self._use, event.permit_id)
        if use is None:
            return
        outcome = outcome_of(event, str(use.content["motion_id"])) or await self._stopped(event, use)
        content = ending(event)
        artefact = motion_artefact(use, self._conductor.journal_folder, content)
        prepared = Prepared(outcome[1], (artefact,), {"motion": artefact.id}, content)
        taken = await asyncio.to_thread(self._in_case, use.case_id, outcome[0], prepared)
        self._tell(event.permit_id, content["cause"], taken, content["distance_mm"], content["angle_deg"])

    async def _stopped(self, event: MotionEnded, use: StoredArtefact) -> tuple[Trigger, Facts]:
        """The end of a motion that was told to stop: late news once the stop is in the record, else the stop itself."""
        await asyncio.to_thread(self._conductor.bridge.wait_for_record, _STOP_RECORDED_WITHIN_S)
        motion_id = str(use.content["motion_id"])
        if await asyncio.to_thread(self._is_running, use.case_id, motion_id):
            return Trigger.STOP, Stopped(person_id="")
        return Trigger.MISSED, MotionOver(motion_id, event.at_rest, event.distance_mm, event.angle_rad)

    async def _move_refused(self, event: MoveRefused) -> None:
        """The guard did not start the motion: it is over where it began."""
        use = await asyncio.to_thread(self._use, event.permit_id)
        if use is None:
            return
        refusal = event.refusal
        problem = {
            "code": refusal.code.value,
            "detail": refusal.message,
            "measured": refusal.measured,
            "limit": refusal.limit,
            "what_to_do": answer_for(refusal.code).what_to_do,
        }
        motion_id = str(use.content["motion_id"])
        artefact = motion_artefact(use, self._conductor.journal_folder, {"cause": "refused", **problem})
        at_rest = refusal.code is not RefusalCode.ARM_NOT_AT_REST
        facts = MotionOver(motion_id, at_rest, distance_mm=None, angle_rad=None)
        prepared = Prepared(facts, (artefact,), {"motion": motion_id}, {"cause": "refused", **problem})
        taken = await asyncio.to_thread(self._in_case, use.case_id, Trigger.MISSED, prepared)
        self._tell(event.permit_id, "refused", taken, None, None, problem)

    async def _fault(self, event: Fault) -> None:
        """A fault; a guard that is lost tells no end of its motion, so whoever holds the button hears of it here."""
        taken = await self._observe(Trigger.FAULT, fault_of(event.kind), {"message": event.message})
        if event.kind is FaultKind.GUARD_LOST and taken is not None:
            state, version = taken.decision.after.state, taken.event.version
            self._endings.tell_all(Ending(event.kind, state, version, None, None, None))

    async def _disturbed(self, event: Disturbed) -> None:
        """A displaced arm; while a sleeve is in, pushing bends it a little, and the drift, if known, decides (H29)."""
        live = self._conductor.live
        if live is not None and drift_decides(live) and self._conductor.bridge.watch.drift() is not None:
            _log.warning("arm_displaced_during_insertion", offset_mm=event.offset_mm)
            return
        offset_mm, angle_deg = event.offset_mm, math.degrees(event.angle_rad)
        what = f"displaced by {offset_mm:.3f} mm and {angle_deg:.3f} deg"
        facts = Movement(observed=True, what=what)
        await self._observe(Trigger.ARM_DISTURBED, facts, {"offset_mm": offset_mm, "angle_deg": angle_deg})

    async def _observe(self, trigger: Trigger, facts: Facts, data: dict[str, Any]) -> Taken | None:
        case_id = await asyncio.to_thread(self._conductor.open_case)
        if case_id is None:
            await asyncio.to_thread(self._outside_a_case, trigger, data)
            return None
        return await asyncio.to_thread(self._in_case, case_id, trigger, Prepared(facts, data=data))

    def _in_case(self, case_id: str, trigger: Trigger, prepared: Prepared) -> Taken:
        return self._conductor.observe(case_id, trigger, lambda _: prepared)

    def _outside_a_case(self, trigger: Trigger, data: dict[str, Any]) -> None:
        with self._conductor.parts.database.write() as connection:
            record_audit(connection, trigger, None, data)

    def _use(self, permit_id: str) -> StoredArtefact | None:
        with self._conductor.parts.database.read() as connection:
            try:
                return store.read_artefact(connection, ArtefactKind.PERMIT_USE, permit_id)
            except ServiceError as error:
                if error.code != ErrorCode.ARTEFACT_UNKNOWN:
                    raise
        _log.error("motion_without_permit", permit_id=permit_id)
        return None

    def _is_running(self, case_id: str, motion_id: str) -> bool:
        running = self._conductor.case_of(case_id).running
        return running is not None and running.id == motion_id

    def _tell(
        self,
        permit_id: str,
        cause: str,
        taken: Taken,
        distance_mm: float | None,
        angle_deg: float | None,
        problem: dict[str, Any] | None = None,
    ) -> None:
        state, version = taken.decision.after.state, taken.event.version
        self._endings.tell(permit_id, Ending(cause, state, version, distance_mm, angle_deg, problem))
