"""What runs beside the requests: the guard, the observer of its events, the image flow, the insertion watch."""

import asyncio
from collections.abc import AsyncIterator, Coroutine
from contextlib import asynccontextmanager
from typing import Any

import structlog
from fastapi import FastAPI

from robot.guard.client import GuardConfig
from service.conductor.conductor import Conductor
from service.conductor.image_flow import ImageFlow
from service.conductor.recovery import recover
from service.conductor.taking import Taken
from service.motion.arm_claim import refuse_claimed_arm
from service.motion.bridge import ArmBridge
from service.motion.endings import Endings
from service.motion.insertion_watch import watch_insertions
from service.motion.observer import MotionObserver
from service.motion.status_bell import StatusBell
from service.parts import Parts
from workflow.decisions import Effect

_log = structlog.get_logger(__name__)


@asynccontextmanager
async def conducting(app: FastAPI, parts: Parts) -> AsyncIterator[None]:
    """The conductor, up; the restart is recorded before the arm or an image can say anything.

    ServiceError arm_claimed where somebody else runs the arm.
    """
    await asyncio.to_thread(refuse_claimed_arm, parts.settings.arm_address)
    bridge = ArmBridge(_guard_config(parts))
    conductor, endings, bell = Conductor(parts, bridge), Endings(), StatusBell()
    images, observer = ImageFlow(conductor), MotionObserver(conductor, endings)
    conductor.on_effect[Effect.STOP_SENT] = lambda taken: _stop(bridge, taken)
    app.state.conductor, app.state.endings, app.state.bell = conductor, endings, bell
    await asyncio.to_thread(recover, conductor)
    parts.arrivals.listen(images.stored)
    bridge.start(observer.take, bell.ring)
    running = (observer.run(), images.take_in_all(), images.work_through(), watch_insertions(conductor))
    tasks = [asyncio.create_task(_supervised(work)) for work in running]
    try:
        yield
    finally:
        await asyncio.to_thread(bridge.close)  # the arm first: ending the guard stops it
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


def _stop(bridge: ArmBridge, taken: Taken) -> None:
    """What must stop has been stopped before it was recorded; once more costs nothing and also locks the guard."""
    bridge.stop(f"recorded: {taken.decision.trigger}")


async def _supervised(work: Coroutine[Any, Any, None]) -> None:
    """A defect in one of these must be seen at once: without it the procedure would silently stand still."""
    try:
        await work
    except asyncio.CancelledError:
        raise
    except Exception:
        _log.exception("background_work_failed", work=repr(work))
        raise


# A guard that a crowded machine does not run for a second is not dead. In a motion the controller's own watchdog, fed
# by nobody meanwhile, has long stopped the arm.
_GUARD_SILENT_S = 2.5


def _guard_config(parts: Parts) -> GuardConfig | None:
    address = parts.settings.arm_address
    folder = parts.settings.data_folder / "guard"
    if address is None:
        return None
    return GuardConfig(arm_address=address, journal_folder=folder, silent_after_s=_GUARD_SILENT_S)
