"""Classification of the controller's safety and mode words."""

from dataclasses import dataclass
from enum import StrEnum


class SafetyState(StrEnum):
    """What keeps the arm from moving, worst first when several hold."""

    FAULT = "fault"
    VIOLATION = "violation"
    EMERGENCY_STOP = "emergency_stop"
    PROTECTIVE_STOP = "protective_stop"
    SAFEGUARD_STOP = "safeguard_stop"
    RECOVERY = "recovery"
    OFF = "off"
    REDUCED = "reduced"
    NORMAL = "normal"


POWER_ON_BIT = 0  # of robot_status_bits
PROGRAM_RUNNING_BIT = 1  # of robot_status_bits
ROBOT_MODE_RUNNING = 7

# safety_status_bits, worst first; bit 10 (stopped for safety) is set with any of them
_STOP_BITS: tuple[tuple[int, SafetyState], ...] = (
    (9, SafetyState.FAULT),
    (8, SafetyState.VIOLATION),
    (7, SafetyState.EMERGENCY_STOP),
    (6, SafetyState.EMERGENCY_STOP),
    (5, SafetyState.EMERGENCY_STOP),
    (2, SafetyState.PROTECTIVE_STOP),
    (4, SafetyState.SAFEGUARD_STOP),
    (3, SafetyState.RECOVERY),
)
_NORMAL_BIT = 0
_REDUCED_BIT = 1
_STOPPED_BIT = 10


@dataclass(frozen=True, slots=True)
class SafetyWords:
    """The words as they arrive on the wire."""

    safety_bits: int
    robot_status_bits: int
    robot_mode: int


def classify(words: SafetyWords) -> SafetyState:
    """Worst state that the words report; contradictory or empty words count as a fault."""
    for bit, state in _STOP_BITS:
        if _has(words.safety_bits, bit):
            return state
    if _has(words.safety_bits, _STOPPED_BIT):
        return SafetyState.FAULT
    if not _has(words.robot_status_bits, POWER_ON_BIT) or words.robot_mode != ROBOT_MODE_RUNNING:
        return SafetyState.OFF
    if _has(words.safety_bits, _REDUCED_BIT):
        return SafetyState.REDUCED
    return SafetyState.NORMAL if _has(words.safety_bits, _NORMAL_BIT) else SafetyState.FAULT


def may_move(state: SafetyState) -> bool:
    """Whether a motion may start or go on; reduced mode only lowers the controller's own speed limits."""
    return state in (SafetyState.NORMAL, SafetyState.REDUCED)


def _has(word: int, bit: int) -> bool:
    return bool(word >> bit & 1)
