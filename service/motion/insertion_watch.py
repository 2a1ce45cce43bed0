"""Watches the arm while a sleeve is in (H29): an alarm, once, where it drifts; a stop where a program could move it."""

import asyncio
import math

import structlog

from service.conductor.conductor import Conductor
from service.conductor.taking import Prepared
from service.errors import ServiceError
from service.motion.displacement import Displacement
from workflow.case import CaseState
from workflow.facts import Faulted, FaultKind, Movement
from workflow.states import INSERTION, State
from workflow.triggers import Trigger

_log = structlog.get_logger(__name__)
_LOOK_EVERY_S = 0.05


async def watch_insertions(conductor: Conductor) -> None:
    """Look until cancelled."""
    alarmed: str | None = None
    while True:
        await asyncio.sleep(_LOOK_EVERY_S)
        try:
            alarmed = await _look(conductor, alarmed)
        except Exception:  # noqa: BLE001  a defect met in one look must not end the watch over a sleeve
            _log.exception("insertion_look_failed")


async def _look(conductor: Conductor, alarmed: str | None) -> str | None:
    """Look once; the insertion whose drift was alarmed of, given the last one."""
    live = conductor.live
    if live is None or live.insertion is None or not drift_decides(live):
        return alarmed
    if live.state in INSERTION and _program_runs(conductor):
        await _stop_program(conductor, live.case_id)
    drift = conductor.bridge.watch.drift()
    if drift is None or live.insertion.id == alarmed or not _is_beyond(conductor, drift):
        return alarmed
    return live.insertion.id if await _alarm(conductor, live.case_id, drift) else alarmed


def drift_decides(case: CaseState) -> bool:
    """Whether a push bends the arm under a sleeve: the drift from the verified pose says what it means.

    A stop while the surgeon drills does not end that, as long as the guide counts as verified.
    """
    stopped = case.state is State.SAFE_HOLD and case.insertion is not None and case.verification is not None
    return case.state in INSERTION or stopped


def _program_runs(conductor: Conductor) -> bool:
    """Whether somebody started one on the controller, with which the lock of an insertion is none any more."""
    reading = conductor.bridge.watch.reading()
    return reading is not None and reading.arm is not None and reading.arm.program_running


async def _stop_program(conductor: Conductor, case_id: str) -> None:
    _log.error("program_during_insertion", case_id=case_id)
    conductor.bridge.stop("a program runs while a sleeve is in")
    await _record(conductor, case_id, Trigger.FAULT, Prepared(Faulted(FaultKind.PROGRAM_STARTED)))


def _is_beyond(conductor: Conductor, drift: Displacement) -> bool:
    limits = conductor.rules.limits
    return drift.offset_mm > limits.drift_mm or drift.angle_rad > limits.drift_rad


async def _alarm(conductor: Conductor, case_id: str, drift: Displacement) -> bool:
    data = {"drift_mm": drift.offset_mm, "drift_deg": math.degrees(drift.angle_rad)}
    facts = Movement(observed=True, what="the guide drifted while a sleeve was in")
    prepared = Prepared(facts, data=data)
    _log.error("insertion_alarm", case_id=case_id, **data)
    return await _record(conductor, case_id, Trigger.ARM_DISTURBED, prepared)


async def _record(conductor: Conductor, case_id: str, trigger: Trigger, prepared: Prepared) -> bool:
    try:
        await asyncio.to_thread(conductor.observe, case_id, trigger, lambda _: prepared)
    except ServiceError as error:
        _log.error("observation_not_recorded", trigger=trigger, code=error.code)
        return False
    return True
