"""What a UR controller says about itself: modes and bits on the wire, faults that a test can plant."""

from enum import IntEnum, IntFlag, StrEnum


class RobotMode(IntEnum):
    """RTDE field robot_mode."""

    POWER_OFF = 3
    IDLE = 5
    RUNNING = 7


class SafetyMode(IntEnum):
    """RTDE field safety_mode."""

    NORMAL = 1
    REDUCED = 2
    PROTECTIVE_STOP = 3
    SAFEGUARD_STOP = 5
    SYSTEM_EMERGENCY_STOP = 6
    ROBOT_EMERGENCY_STOP = 7
    VIOLATION = 8
    FAULT = 9


class RuntimeState(IntEnum):
    """RTDE field runtime_state."""

    STOPPING = 0
    STOPPED = 1
    PLAYING = 2
    PAUSING = 3
    PAUSED = 4
    RESUMING = 5


class SafetyBit(IntFlag):
    """RTDE field safety_status_bits."""

    NORMAL = 1 << 0
    REDUCED = 1 << 1
    PROTECTIVE_STOP = 1 << 2
    RECOVERY = 1 << 3
    SAFEGUARD_STOP = 1 << 4
    SYSTEM_EMERGENCY_STOP = 1 << 5
    ROBOT_EMERGENCY_STOP = 1 << 6
    EMERGENCY_STOP = 1 << 7
    VIOLATION = 1 << 8
    FAULT = 1 << 9
    STOPPED_FOR_SAFETY = 1 << 10


class Fault(StrEnum):
    """What `inject` plants and `clear` takes away again."""

    # The arm stops. `clear` removes the cause; the stop itself is released as on a
    # real arm (unlock after 5 s, power on, brake release).
    PROTECTIVE_STOP = "protective_stop"
    SAFEGUARD_STOP = "safeguard_stop"
    SYSTEM_EMERGENCY_STOP = "system_emergency_stop"
    ROBOT_EMERGENCY_STOP = "robot_emergency_stop"
    SAFETY_VIOLATION = "safety_violation"
    SAFETY_FAULT = "safety_fault"
    REDUCED_MODE = "reduced_mode"
    # The feedback lies; the arm goes on.
    TIMESTAMP_STOPS = "timestamp_stops"
    VALUES_FREEZE = "values_freeze"
    VALUES_NAN = "values_nan"
    PACKETS_OUT_OF_ORDER = "packets_out_of_order"
    PACKETS_STOP = "packets_stop"
    PACKETS_LATE = "packets_late"  # by half a second, each of them
    PACKETS_FALL_BEHIND = "packets_fall_behind"  # each a fifth of a cycle more than the last, up to that half second
    BYTES_DRIP = "bytes_drip"  # one byte a cycle
    # The connections break, and stay refused until cleared.
    RTDE_CLOSED = "rtde_closed"
    SCRIPT_PORT_CLOSED = "script_port_closed"
    DASHBOARD_CLOSED = "dashboard_closed"
    HANDSHAKE_MUTE = "handshake_mute"
    RTDE_RESET = "rtde_reset"  # cut once with a TCP reset when planted; new connections are taken
    SWITCHED_OFF = "switched_off"  # without power until cleared; then its clock begins anew and the arm is off
    # Somebody at the pendant takes the arm: the program ends, and neither uploads nor the dashboard move it until
    # cleared. That a dashboard in local control refuses `stop` as well is assumed, as the worst case.
    LOCAL_CONTROL = "local_control"
    # The arm misbehaves.
    FORCE_STEP = "force_step"
    FALLS_SHORT = "falls_short"
    IGNORES_UPLOADS = "ignores_uploads"


class WatchdogOutcome(StrEnum):
    """What a missed watchdog does; documented as a stopped program, seen on a simulator as a protective stop."""

    STOP_PROGRAM = "stop_program"
    PROTECTIVE_STOP = "protective_stop"


class PowerAction(StrEnum):
    """What a person does at the pendant with the arm's power."""

    OFF = "off"
    ON = "on"
    RELEASE_BRAKES = "release_brakes"
