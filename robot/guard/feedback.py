"""Judgement of the controller's feedback: fresh, finite, in order, and not frozen (H21)."""

from enum import StrEnum

import numpy as np

from robot.arm import ArmState
from robot.guard.rest import is_slow

STALE_S = 0.1  # since the arm was as the newest good reading tells
# By how much more a second of the controller may last than one here: crystals differ by a tenth of it, and the system's
# clock may be slewed by half. A stream that falls behind more slowly than that is not noticed.
_CLOCKS_DIFFER = 1e-3
_LARGEST = 1e100  # of a reading's numbers, so that the square of none overflows
_FROZEN_S = 0.1  # a pose that stays equal to the last bit while the same reading claims a speed


class Verdict(StrEnum):
    """What a reading is worth."""

    GOOD = "good"
    NOT_FINITE = "not_finite"
    OUT_OF_ORDER = "out_of_order"
    FROZEN = "frozen"


class FeedbackWatch:
    """Remembers the newest good reading and what was wrong with the others; pure, the clock is in the readings.

    A reading counts as older by what its packet took beyond the promptest one: what arrives steadily through a switch
    that has fallen behind tells of an arm that was. What the promptest took is not known here (`Admission`).
    """

    def __init__(self) -> None:
        self._newest: ArmState | None = None
        self._changed_at_s = 0.0
        self._least_lag_s = 0.0  # of this clock behind the controller's, whatever that counts from
        self._late_s = 0.0

    @property
    def newest(self) -> ArmState | None:
        """Newest good reading, however old."""
        return self._newest

    @property
    def late_s(self) -> float:
        """How much longer the newest good reading was on its way than the promptest."""
        return self._late_s

    def take(self, reading: ArmState) -> Verdict:
        """Judge a reading and keep it if it is good."""
        if not _is_finite(reading):
            return Verdict.NOT_FINITE
        before = self._newest
        if before is not None and reading.controller_time_s <= before.controller_time_s:
            return Verdict.OUT_OF_ORDER
        if before is None or not np.array_equal(before.joints_rad, reading.joints_rad):
            self._changed_at_s = reading.received_at_s
        self._time(before, reading)
        self._newest = reading
        stuck_s = reading.received_at_s - self._changed_at_s
        return Verdict.FROZEN if stuck_s > _FROZEN_S and not is_slow(reading) else Verdict.GOOD

    def is_fresh(self, now_s: float) -> bool:
        """Whether there is a good reading younger than the limit."""
        return self._newest is not None and now_s - self._newest.received_at_s + self._late_s <= STALE_S

    def forget(self) -> None:
        """Start anew after a reconnection: a controller that was restarted counts its time from zero."""
        self._newest = None

    def _time(self, before: ArmState | None, reading: ArmState) -> None:
        lag_s = reading.received_at_s - reading.controller_time_s
        if before is None:
            self._least_lag_s = lag_s
        else:
            since_s = reading.received_at_s - before.received_at_s
            self._least_lag_s = min(lag_s, self._least_lag_s + _CLOCKS_DIFFER * since_s)
        self._late_s = lag_s - self._least_lag_s


def _is_finite(reading: ArmState) -> bool:
    numbers = (
        reading.joints_rad,
        reading.joint_speeds_rad_s,
        reading.base_from_tcp.ravel(),
        reading.tcp_force_n,
        reading.payload_centre_mm,
        (reading.controller_time_s, reading.tcp_speed_mm_s, reading.tcp_turn_speed_rad_s, reading.payload_kg),
    )
    return bool((np.abs(np.concatenate(numbers)) < _LARGEST).all())
