"""Whether the arm is at rest, and whether it was displaced while nobody moved it; pure."""

import numpy as np

from robot.arm import ArmState
from robot.frames import Transform, distance_between
from robot.guard.messages import Disturbed

REST_SPEED_MM_S = 0.5  # above the noise of a UR5's reported speed
REST_TURN_RAD_S = 0.005
_REST_DRIFT_MM = 0.03  # within one rest; below the displacement that voids an image
_REST_DRIFT_RAD = float(np.deg2rad(0.01))
DISTURBED_MM = 0.05  # H04
DISTURBED_RAD = float(np.deg2rad(0.02))  # H04
_GATHERED_S = 0.1  # a push is told whole, and an arm that is jogged on ten times a second


class RestWatch:
    """How long the arm has been at rest: no speed above the noise, and no drift from where the rest began."""

    def __init__(self) -> None:
        self._base_from_rest: Transform | None = None
        self._since_s = 0.0

    def observe(self, reading: ArmState) -> float:
        """Seconds at rest up to this reading; 0 while moving."""
        if not is_slow(reading):
            self._base_from_rest = None
            return 0.0
        if self._base_from_rest is None or _drifted(self._base_from_rest, reading):
            self._base_from_rest = reading.base_from_tcp
            self._since_s = reading.received_at_s
        return reading.received_at_s - self._since_s


class DisplacementWatch:
    """Compares each reading with where the last accounted motion left the arm (H04)."""

    def __init__(self) -> None:
        self._base_from_left: Transform | None = None
        self._since_s: float | None = None
        self._peak = (0.0, 0.0)

    def observe(self, reading: ArmState) -> Disturbed | None:
        """A displacement that no motion accounts for: its peak since it began, a moment later.

        The arm is then expected to stay where it is, so that one that is jogged on is reported again and again.
        """
        if self._base_from_left is None:
            self._base_from_left = reading.base_from_tcp
        offset_mm, angle_rad = distance_between(self._base_from_left, reading.base_from_tcp)
        if self._since_s is None and (offset_mm > DISTURBED_MM or angle_rad > DISTURBED_RAD):
            self._since_s = reading.received_at_s
        self._peak = (max(self._peak[0], offset_mm), max(self._peak[1], angle_rad))
        if self._since_s is None or reading.received_at_s - self._since_s < _GATHERED_S:
            return None
        disturbed = Disturbed(self._since_s, *self._peak)
        self.account(reading)
        return disturbed

    def account(self, left: ArmState | None) -> None:
        """A motion of the guard left the arm here, as far as it was seen."""
        self._base_from_left = None if left is None else left.base_from_tcp
        self._since_s = None
        self._peak = (0.0, 0.0)


def is_slow(reading: ArmState) -> bool:
    """Whether the reported speeds are no more than noise."""
    return reading.tcp_speed_mm_s < REST_SPEED_MM_S and reading.tcp_turn_speed_rad_s < REST_TURN_RAD_S


def _drifted(base_from_rest: Transform, reading: ArmState) -> bool:
    offset_mm, angle_rad = distance_between(base_from_rest, reading.base_from_tcp)
    return offset_mm > _REST_DRIFT_MM or angle_rad > _REST_DRIFT_RAD
