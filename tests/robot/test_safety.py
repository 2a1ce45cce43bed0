"""Classification of the controller's words."""

import pytest

from robot.safety import SafetyState, SafetyWords, classify, may_move

ON, RUNNING = 1, 7


@pytest.mark.parametrize(
    ("bits", "state"),
    [
        (0b1, SafetyState.NORMAL),
        (0b11, SafetyState.REDUCED),
        (0b10, SafetyState.REDUCED),
        (1 << 2 | 1 << 10, SafetyState.PROTECTIVE_STOP),
        (1 << 4 | 1 << 10, SafetyState.SAFEGUARD_STOP),
        (1 << 5 | 1 << 10, SafetyState.EMERGENCY_STOP),
        (1 << 6 | 1 << 10, SafetyState.EMERGENCY_STOP),
        (1 << 7 | 1 << 2, SafetyState.EMERGENCY_STOP),
        (1 << 8, SafetyState.VIOLATION),
        (1 << 9 | 1 << 7, SafetyState.FAULT),
        (1 << 3, SafetyState.RECOVERY),
        (1 << 10, SafetyState.FAULT),
        (1 | 1 << 10, SafetyState.FAULT),  # normal and stopped for safety contradict each other
        (0, SafetyState.FAULT),
    ],
)
def test_worst_bit_decides(bits: int, state: SafetyState) -> None:
    assert classify(SafetyWords(bits, ON, RUNNING)) is state


@pytest.mark.parametrize(("status", "mode"), [(0, RUNNING), (ON, 3), (ON, 5)])
def test_arm_without_power_or_with_brakes_is_off(status: int, mode: int) -> None:
    assert classify(SafetyWords(1, status, mode)) is SafetyState.OFF


def test_only_normal_and_reduced_may_move() -> None:
    assert {state for state in SafetyState if may_move(state)} == {SafetyState.NORMAL, SafetyState.REDUCED}
