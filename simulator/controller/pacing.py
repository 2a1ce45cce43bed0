"""When controller cycles are due."""

import time
from collections.abc import Callable

# A longer delay than this many cycles is not caught up: the controller's clock stood still, as its process did.
_CATCH_UP_CYCLES = 25


class Pacing:
    """Cycles at multiples of the period from one origin, so that delays do not add up."""

    def __init__(self, period_s: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._period_s = period_s
        self._clock = clock
        self._origin_s = clock()
        self._done = 0
        self.worst_delay_s = 0.0
        self.stalled_s = 0.0

    def wait_s(self) -> float:
        """Until the next cycle is due; negative when it is late."""
        return self._origin_s + (self._done + 1) * self._period_s - self._clock()

    def note(self) -> None:
        """Count a cycle that begins now, and give up time that is too long gone."""
        delay_s = -self.wait_s()
        self._done += 1
        self.worst_delay_s = max(self.worst_delay_s, delay_s)
        if delay_s > _CATCH_UP_CYCLES * self._period_s:
            self._origin_s += delay_s
            self.stalled_s += delay_s
