"""The force at the TCP, against what was felt at rest before the motion (H12); pure."""

from collections import deque

import numpy as np

from robot.arm import ArmState
from robot.frames import Array
from robot.guard.rest import is_slow
from robot.refusal import Refusal, RefusalCode

# A CB3 arm estimates the force from its motor currents, to about 10 N beside a constant part (weight of the guide,
# friction). Three times that is no noise any more, and below half of the 65 N that ISO/TS 15066 allows to press on the
# most sensitive region of a body.
FORCE_RISE_N = 30.0
_FILTERED = 5  # readings of a median: a rise that lasts is seen after 3, 24 ms at 125 Hz, and a spike of 2 is none
_AT_REST = 25  # readings of the baseline, 0.2 s at 125 Hz


class RestingForce:
    """Mean force of the newest readings at rest."""

    def __init__(self) -> None:
        self._felt: deque[Array] = deque(maxlen=_AT_REST)

    @property
    def newest_n(self) -> Array | None:
        """(3,), base axes; None before the first reading at rest."""
        return np.mean(self._felt, axis=0) if self._felt else None

    def observe(self, reading: ArmState) -> None:
        """Take a reading in, unless the arm moves."""
        if is_slow(reading):
            self._felt.append(reading.tcp_force_n)


def refuse_force(resting_n: Array | None) -> Refusal | None:
    """Refusal of a motion for the force at rest (3,), which is small once the payload is the compared one."""
    force_n = None if resting_n is None else float(np.linalg.norm(resting_n))
    if force_n is not None and force_n <= FORCE_RISE_N:
        return None
    return Refusal(RefusalCode.FORCE_AT_REST, "a force at the TCP before the motion (N)", force_n, FORCE_RISE_N)


class ForceWatch:
    """Compares a running median with the force before the motion.

    Parameters
    ----------
    resting_n : (3,)
        Baseline, base axes.
    """

    def __init__(self, resting_n: Array) -> None:
        self._resting_n = resting_n
        self._felt: deque[Array] = deque([resting_n] * _FILTERED, maxlen=_FILTERED)

    def observe(self, reading: ArmState) -> float:
        """Rise of the force up to this reading, N: the norm of the medians' difference from the baseline."""
        self._felt.append(reading.tcp_force_n)
        return float(np.linalg.norm(np.median(self._felt, axis=0) - self._resting_n))
