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
        self._braking = 0.0
        self._holding = 0.0
        self._held = False

    @property
    def at_rest(self) -> bool:
        """Whether it stands and will not go on by itself: arrived, ended or held."""
        return self.speed == 0.0 and (self.arrived or self._held or self._braking > 0.0)

    @property
    def arrived(self) -> bool:
        """Whether the end of the path is reached."""
        return self.position >= self.length

    def brake(self, deceleration: float) -> None:
        """End the motion: slow down to rest from the next cycle on."""
        self._braking = max(self._braking, deceleration)

    def hold(self, within_s: float) -> None:
        """Interrupt the motion: slow down to rest in this time."""
        self._holding = max(self._holding, self.speed / within_s)
        self._held = True

    def release(self) -> None:
        """Go on after a hold, unless the motion was ended."""
        self._holding, self._held = 0.0, False

    def advance(self, cycle_s: float, scaling: float = 1.0) -> None:
        """Move on by one cycle."""
        if self.arrived:
            self.speed = 0.0
        elif self._held or self._braking > 0.0:
            self._step(max(0.0, self.speed - max(self._holding, self._braking) * cycle_s), cycle_s)
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
