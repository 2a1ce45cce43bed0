"""What the service knows of the arm, from the guard's reports: newest reading, displacements, latched poses.

Fed in the thread that reads the guard's pipe, asked from any.
"""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from robot.arm import ArmState
from robot.frames import Transform, distance_between
from robot.guard.messages import EndCause, Event, Fault, FaultKind, MotionEnded, MotionStarted, Phase, Status
from robot.guard.rest import is_slow
from service.elapsed import elapsed_s
from service.motion.displacement import Displacement, DisplacementLedger
from service.motion.exposures import Exposure, Exposures

# A status comes every 25 ms; a snapshot waits for one no older than this, so that a busy machine refuses nothing.
_YOUNG_S = 0.05
# Slow or not, the arm is not at rest before the guard has seen its motion's end: what is acknowledged earlier, the end
# of a motion that was stopped locks again.
_UNDER_WAY = (Phase.MOVING, Phase.STOPPING)


@dataclass(frozen=True, slots=True, eq=False)
class ArmReading:
    """One status with its ages; every age counts from when the thing was true."""

    status: Status
    status_age_s: float
    arm: ArmState | None
    arm_age_s: float
    advances: bool
    at_rest: bool | None


class ArmWatch:
    """The newest of everything.

    Parameters
    ----------
    clock, elapsed : callable
        The clock of the guard's messages, and the one that an image ages by.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic, elapsed: Callable[[], float] = elapsed_s) -> None:
        self._clock = clock
        self._elapsed = elapsed
        self._changed = threading.Condition()
        self._status: Status | None = None
        self._before: ArmState | None = None
        self._ledger = DisplacementLedger()
        self._exposures = Exposures()
        self._base_from_rest: Transform | None = None

    def take(self, event: Event) -> None:
        """Take in what the guard says."""
        with self._changed:
            match event:
                case Status():
                    self._take_status(event)
                case MotionStarted():
                    self._ledger.start_motion(event.base_from_start)
                    self._base_from_rest = None
                case MotionEnded():
                    self._ledger.end_motion(event.arm)
                    arrived = event.cause is EndCause.ARRIVED and event.arm is not None
                    self._base_from_rest = event.arm.base_from_tcp if arrived and event.arm else None
                case Fault(kind=FaultKind.GUARD_LOST):
                    self._ledger.lose_motion()
                case _:
                    return
            self._changed.notify_all()

    def reading(self, wait_s: float = 0.0) -> ArmReading | None:
        """The newest status, after waiting at most `wait_s` for a young one; None before the first."""
        with self._changed:
            if self._status is None:
                return None
            self._changed.wait_for(self._is_young, wait_s)
            return self._reading(self._status)

    def open_exposure(self, window_id: str) -> ArmState | None:
        """Latch the pose for an exposure; None (and no exposure) without a reading."""
        with self._changed:
            arm = self._arm()
            if arm is not None:
                latched_at_s = self._elapsed() - (self._clock() - arm.received_at_s)
                self._exposures.open(window_id, arm, latched_at_s, self._ledger.begin_stretch(arm))
            return arm

    def exposure_of_window(self, window_id: str) -> Exposure | None:
        """The exposure of a window."""
        with self._changed:
            return self._exposures.of_window(window_id)

    def exposure_of_image(self, image_id: str) -> Exposure | None:
        """The exposure that an image came from."""
        with self._changed:
            return self._exposures.of_image(image_id)

    def assign_exposure(self, window_id: str, image_id: str) -> None:
        """The image of a window arrived."""
        with self._changed:
            self._exposures.assign(window_id, image_id)

    def since_exposure_s(self, image_id: str | None) -> float | None:
        """Time since the exposure of an image was requested; None if that is unknown."""
        exposure = self.exposure_of_image(image_id or "")
        return None if exposure is None else self._elapsed() - exposure.requested_at_s

    def unaccounted(self, image_id: str | None) -> Displacement | None:
        """What no motion accounts for since the exposure of an image; None if that is unknown."""
        with self._changed:
            exposure, arm = self._exposures.of_image(image_id or ""), self._arm()
            if exposure is None or arm is None:
                return None
            return self._ledger.since(exposure.baseline, arm)

    def drift(self) -> Displacement | None:
        """Displacement from where the last motion arrived; None if none did."""
        with self._changed:
            arm = self._arm()
            if self._base_from_rest is None or arm is None:
                return None
            return Displacement(*distance_between(self._base_from_rest, arm.base_from_tcp))

    def _take_status(self, status: Status) -> None:
        if not _is_one_reading(self._arm(), status.arm):
            self._before = self._arm()
        self._status = status
        if status.arm is not None and status.phase is not Phase.MOVING:
            self._ledger.observe(status.arm)
        if status.arm is not None:
            self._exposures.observe(status.arm)

    def _arm(self) -> ArmState | None:
        return None if self._status is None else self._status.arm

    def _is_young(self) -> bool:
        return self._status is not None and self._clock() - self._status.sent_at_s <= _YOUNG_S

    def _reading(self, status: Status) -> ArmReading:
        now_s, arm, before = self._clock(), status.arm, self._before
        return ArmReading(
            status=status,
            status_age_s=now_s - status.sent_at_s,
            arm=arm,
            arm_age_s=float("inf") if arm is None else now_s - arm.received_at_s,
            advances=bool(arm and before and status.connected and arm.controller_time_s > before.controller_time_s),
            at_rest=None if arm is None else is_slow(arm) and status.phase not in _UNDER_WAY,
        )


def _is_one_reading(before: ArmState | None, now: ArmState | None) -> bool:
    """Whether a status tells again what the last one did, as beside an event that has one of its own."""
    return before is not None and now is not None and before.controller_time_s == now.controller_time_s
