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
_REPEAT_S = 0.5  # an arm that is jogged on is reported twice a second


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
        self._quiet_until_s = 0.0

    def observe(self, reading: ArmState) -> Disturbed | None:
        """A displacement that no motion accounts for; the arm is then expected to stay where it is now."""
        if self._base_from_left is None:
            self._base_from_left = reading.base_from_tcp
        if reading.received_at_s < self._quiet_until_s:
            return None
        offset_mm, angle_rad = distance_between(self._base_from_left, reading.base_from_tcp)
        if offset_mm <= DISTURBED_MM and angle_rad <= DISTURBED_RAD:
            return None
        self._base_from_left = reading.base_from_tcp
        self._quiet_until_s = reading.received_at_s + _REPEAT_S
        return Disturbed(reading.received_at_s, offset_mm, angle_rad)

    def account(self, left: ArmState | None) -> None:
        """A motion of the guard left the arm here; unknown after one that ended without feedback."""
        self._base_from_left = None if left is None else left.base_from_tcp


def is_slow(reading: ArmState) -> bool:
    """Whether the reported speeds are no more than noise."""
    return reading.tcp_speed_mm_s < REST_SPEED_MM_S and reading.tcp_turn_speed_rad_s < REST_TURN_RAD_S


def _drifted(base_from_rest: Transform, reading: ArmState) -> bool:
    offset_mm, angle_rad = distance_between(base_from_rest, reading.base_from_tcp)
    return offset_mm > _REST_DRIFT_MM or angle_rad > _REST_DRIFT_RAD
