"""The guard's eyes: reads the arm, keeps the link, and says what is wrong while no motion runs."""

from robot.arm import Arm, ArmState
from robot.frames import Array
from robot.guard.feedback import FeedbackWatch, Verdict
from robot.guard.force import RestingForce
from robot.guard.messages import FaultKind
from robot.guard.rest import RestWatch
from robot.safety import SafetyState

_RECONNECT_S = 1.0  # between attempts; each may block for as long as the library's constructor does

_SAFETY_FAULTS = {
    SafetyState.PROTECTIVE_STOP: FaultKind.PROTECTIVE_STOP,
    SafetyState.SAFEGUARD_STOP: FaultKind.SAFEGUARD_STOP,
    SafetyState.EMERGENCY_STOP: FaultKind.EMERGENCY_STOP,
    SafetyState.OFF: FaultKind.ARM_OFF,
    SafetyState.VIOLATION: FaultKind.SAFETY_FAULT,
    SafetyState.FAULT: FaultKind.SAFETY_FAULT,
    SafetyState.RECOVERY: FaultKind.SAFETY_FAULT,
}


class Observer:
    """Readings of one arm, judged."""

    def __init__(self, arm: Arm) -> None:
        self._arm = arm
        self._feedback = FeedbackWatch()
        self._rest = RestWatch()
        self._resting_force = RestingForce()
        self._bad: Verdict | None = None
        self._next_attempt_s = 0.0
        self.rest_s = 0.0

    @property
    def newest(self) -> ArmState | None:
        """Newest good reading, however old."""
        return self._feedback.newest

    @property
    def resting_force_n(self) -> Array | None:
        """(3,), base axes: mean force of the newest readings at rest; None before the first."""
        return self._resting_force.newest_n

    def read(self) -> ArmState | None:
        """A new good reading, or None."""
        reading = self._arm.read()
        if reading is None:
            return None
        verdict = self._feedback.take(reading)
        self._bad = None if verdict is Verdict.GOOD else verdict
        if self._bad is not None:
            return None
        self.rest_s = self._rest.observe(reading)
        self._resting_force.observe(reading)
        return reading

    def is_sound(self, now_s: float) -> bool:
        """Whether the newest reading is good and fresh (H21)."""
        return self._bad is None and self._feedback.is_fresh(now_s)

    @property
    def late_s(self) -> float:
        """How much longer the newest good reading was on its way than the promptest of this connection."""
        return self._feedback.late_s

    def fault(self, now_s: float) -> FaultKind | None:
        """What keeps the arm from moving now."""
        newest = self._feedback.newest
        if newest is None or not self.is_sound(now_s):
            return FaultKind.FEEDBACK_LOST
        return _SAFETY_FAULTS.get(newest.safety)

    def keep_connected(self, now_s: float) -> None:
        """Connect again while nothing good arrives; blocks for as long as the library does."""
        if self.is_sound(now_s) or now_s < self._next_attempt_s:
            return
        self._next_attempt_s = now_s + _RECONNECT_S
        if self._arm.connect():
            self._feedback.forget()
