"""Safety stops and power of the arm, latched and released as the dashboard of a real one does."""

from simulator.controller.states import Fault, RobotMode, SafetyBit, SafetyMode

POWER_CHANGE_S = 0.5

_STOPS = {
    Fault.SAFETY_FAULT: SafetyMode.FAULT,
    Fault.SAFETY_VIOLATION: SafetyMode.VIOLATION,
    Fault.ROBOT_EMERGENCY_STOP: SafetyMode.ROBOT_EMERGENCY_STOP,
    Fault.SYSTEM_EMERGENCY_STOP: SafetyMode.SYSTEM_EMERGENCY_STOP,
    Fault.SAFEGUARD_STOP: SafetyMode.SAFEGUARD_STOP,
    Fault.PROTECTIVE_STOP: SafetyMode.PROTECTIVE_STOP,
    Fault.REDUCED_MODE: SafetyMode.REDUCED,
}  # the gravest first

_RESTARTS = (SafetyMode.FAULT, SafetyMode.VIOLATION)  # released by "restart safety" alone
_POWER_CUTS = (*_RESTARTS, SafetyMode.ROBOT_EMERGENCY_STOP, SafetyMode.SYSTEM_EMERGENCY_STOP)

_BITS = {
    SafetyMode.NORMAL: SafetyBit.NORMAL,
    SafetyMode.REDUCED: SafetyBit.REDUCED,
    SafetyMode.PROTECTIVE_STOP: SafetyBit.PROTECTIVE_STOP | SafetyBit.STOPPED_FOR_SAFETY,
    SafetyMode.SAFEGUARD_STOP: SafetyBit.SAFEGUARD_STOP | SafetyBit.STOPPED_FOR_SAFETY,
    SafetyMode.SYSTEM_EMERGENCY_STOP: (
        SafetyBit.SYSTEM_EMERGENCY_STOP | SafetyBit.EMERGENCY_STOP | SafetyBit.STOPPED_FOR_SAFETY
    ),
    SafetyMode.ROBOT_EMERGENCY_STOP: (
        SafetyBit.ROBOT_EMERGENCY_STOP | SafetyBit.EMERGENCY_STOP | SafetyBit.STOPPED_FOR_SAFETY
    ),
    SafetyMode.VIOLATION: SafetyBit.VIOLATION | SafetyBit.STOPPED_FOR_SAFETY,
    SafetyMode.FAULT: SafetyBit.FAULT | SafetyBit.STOPPED_FOR_SAFETY,
}


class Safety:
    """The present stop, if any, and the arm's power; time is the controller's."""

    def __init__(self, emergency_robot_mode: RobotMode, unlock_delay_s: float) -> None:
        self._emergency_robot_mode = emergency_robot_mode
        self._unlock_delay_s = unlock_delay_s
        self.reset()

    def reset(self) -> None:
        """As when a person has released and powered everything."""
        self.mode = SafetyMode.NORMAL
        self.robot_mode = RobotMode.RUNNING
        self._protective_since_s: float | None = None
        self._restart_needed: SafetyMode | None = None
        self._power_change: tuple[float, RobotMode] | None = None

    @property
    def may_move(self) -> bool:
        """Whether a program or a jog may move the arm."""
        return self.robot_mode is RobotMode.RUNNING and self.mode in (SafetyMode.NORMAL, SafetyMode.REDUCED)

    @property
    def bits(self) -> int:
        """RTDE field safety_status_bits."""
        return int(_BITS[self.mode])

    def update(self, faults: frozenset[Fault], now_s: float) -> None:
        """Latch what the faults ask for, let go of what needs no release, and finish changes of power."""
        if Fault.PROTECTIVE_STOP in faults and self._protective_since_s is None:
            self.stop_protectively(now_s)
        self.mode = self._gravest(faults)
        if self.mode in _RESTARTS:
            self._restart_needed = self.mode
        if self.mode in _POWER_CUTS:
            self.robot_mode, self._power_change = self._emergency_robot_mode, None
        elif self._power_change is not None and now_s >= self._power_change[0]:
            self.robot_mode, self._power_change = self._power_change[1], None

    def stop_protectively(self, now_s: float) -> None:
        """Latch a protective stop, or begin its delay anew."""
        self._protective_since_s = now_s
        if self.mode in (SafetyMode.NORMAL, SafetyMode.REDUCED):
            self.mode = SafetyMode.PROTECTIVE_STOP

    def unlock(self, now_s: float) -> bool:
        """Release the protective stop; False so soon after it."""
        if self._protective_since_s is not None and now_s - self._protective_since_s < self._unlock_delay_s:
            return False
        self._protective_since_s = None
        return True

    def restart(self) -> None:
        """Release a violation or fault; the arm stays without power."""
        self._restart_needed = None

    def power_off(self) -> None:
        """Cut the power at once."""
        self.robot_mode, self._power_change = RobotMode.POWER_OFF, None

    def power_on(self, now_s: float) -> None:
        """Begin to power the arm, brakes on."""
        if self.robot_mode is RobotMode.POWER_OFF and self.mode not in _POWER_CUTS:
            self._power_change = (now_s + POWER_CHANGE_S, RobotMode.IDLE)

    def release_brakes(self, now_s: float) -> None:
        """Begin to release the brakes; powers the arm first if need be."""
        if self.robot_mode is not RobotMode.RUNNING and self.mode not in _POWER_CUTS:
            self._power_change = (now_s + POWER_CHANGE_S, RobotMode.RUNNING)

    def _gravest(self, faults: frozenset[Fault]) -> SafetyMode:
        latched: set[SafetyMode] = {
            mode for fault, mode in _STOPS.items() if fault in faults and mode is not SafetyMode.PROTECTIVE_STOP
        }
        if self._protective_since_s is not None:
            latched.add(SafetyMode.PROTECTIVE_STOP)
        if self._restart_needed is not None:
            latched.add(self._restart_needed)
        return next((mode for mode in _STOPS.values() if mode in latched), SafetyMode.NORMAL)
