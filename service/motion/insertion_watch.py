"""Watches the arm's pose while a sleeve is in (H29): beyond the limits an alarm, once per insertion."""

import asyncio
import math

import structlog

from service.conductor.conductor import Conductor
from service.conductor.taking import Prepared
from service.errors import ServiceError
from service.motion.displacement import Displacement
from workflow.facts import Movement
from workflow.states import INSERTION
from workflow.triggers import Trigger

_log = structlog.get_logger(__name__)
_LOOK_EVERY_S = 0.05


async def watch_insertions(conductor: Conductor) -> None:
    """Look until cancelled."""
    alarmed: str | None = None
    while True:
        await asyncio.sleep(_LOOK_EVERY_S)
        live = conductor.live
        if live is None or live.state not in INSERTION or live.insertion is None or live.insertion.id == alarmed:
            continue
        drift = conductor.bridge.watch.drift()
        if drift is not None and _is_beyond(conductor, drift) and await _alarm(conductor, live.case_id, drift):
            alarmed = live.insertion.id


def _is_beyond(conductor: Conductor, drift: Displacement) -> bool:
    limits = conductor.rules.limits
    return drift.offset_mm > limits.drift_mm or drift.angle_rad > limits.drift_rad


async def _alarm(conductor: Conductor, case_id: str, drift: Displacement) -> bool:
    data = {"drift_mm": drift.offset_mm, "drift_deg": math.degrees(drift.angle_rad)}
    facts = Movement(observed=True, what="the guide drifted while a sleeve was in")
    prepared = Prepared(facts, data=data)
    _log.error("insertion_alarm", case_id=case_id, **data)
    try:
        await asyncio.to_thread(conductor.observe, case_id, Trigger.ARM_DISTURBED, lambda _: prepared)
    except ServiceError as error:
        _log.error("observation_not_recorded", trigger=Trigger.ARM_DISTURBED, code=error.code)
        return False
    return True
