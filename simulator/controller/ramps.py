"""Trapezoidal ramps along a path, one controller cycle at a time."""

from math import sqrt


class Ramp:
    """Position and speed along a path of a given length, with one acceleration for both flanks.

    The state advances cycle by cycle instead of along a formula of time, so that a changed speed scaling, a stop and
    a resume need no second trajectory and never exceed the acceleration.
    """

    def __init__(self, length: float, cruise: float, acceleration: float, speed: float = 0.0) -> None:
        self.length = length
        self.position = 0.0
        self.speed = speed
        self._cruise = cruise
        self._acceleration = acceleration
        self._deceleration: float | None = None

    @property
    def at_rest(self) -> bool:
        """Whether the speed is zero: arrived, braked, or not yet started."""
        return self.speed == 0.0

    @property
    def arrived(self) -> bool:
        """Whether the end of the path is reached."""
        return self.position >= self.length

    @property
    def braking(self) -> bool:
        """Whether a stop was asked for."""
        return self._deceleration is not None

    def brake(self, deceleration: float) -> None:
        """Slow down to rest from the next cycle on."""
        self._deceleration = deceleration

    def resume(self) -> None:
        """Go on towards the end after a brake."""
        self._deceleration = None

    def advance(self, cycle_s: float, scaling: float = 1.0) -> None:
        """Move on by one cycle."""
        if self.arrived:
            self.speed = 0.0
        elif self._deceleration is not None:
            self._step(max(0.0, self.speed - self._deceleration * cycle_s), cycle_s)
        else:
            self._approach(cycle_s, scaling)

    def _approach(self, cycle_s: float, scaling: float) -> None:
        change = self._acceleration * cycle_s
        wanted = min(self.speed + change, self._cruise * scaling, self._speed_that_can_stop(cycle_s))
        if wanted <= 0.0 and scaling > 0.0:  # less than half a cycle's braking is left
            self.position, self.speed = self.length, 0.0
        else:
            self._step(max(wanted, self.speed - change, 0.0), cycle_s)

    def _speed_that_can_stop(self, cycle_s: float) -> float:
        """Speed at the cycle's end from which a constant deceleration stops at the end of the path."""
        half = self._acceleration * cycle_s / 2.0
        room = self.length - self.position - self.speed * cycle_s / 2.0
        squared = half * half + 2.0 * self._acceleration * room
        return sqrt(squared) - half if squared > 0.0 else 0.0

    def _step(self, speed: float, cycle_s: float) -> None:
        self.position = min(self.length, self.position + (self.speed + speed) / 2.0 * cycle_s)
        self.speed = 0.0 if self.arrived else speed
