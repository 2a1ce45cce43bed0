"""What the arm's library raises, as the protocol of an arm has it: no fault of the wire may end the guard."""

from collections.abc import Callable

import numpy as np
import pytest

from robot import ur5
from robot.arm import LinearMove
from robot.errors import ControllerRefusedError
from robot.safety import SafetyState
from robot.ur5 import UR5


class Broken:
    """An interface whose connection broke after the script was uploaded."""

    def __init__(self, _address: str) -> None:
        self.armed = True

    def isProgramRunning(self) -> bool:  # noqa: N802  # the library's name
        return True

    def setWatchdog(self, _hz: float) -> bool:  # noqa: N802  # the library's name
        return self.armed

    def __getattr__(self, name: str) -> Callable[..., object]:
        def call(*_: object) -> object:
            raise RuntimeError(f"write: Broken pipe in {name}")

        return call


@pytest.fixture
def arm(monkeypatch: pytest.MonkeyPatch) -> UR5:
    monkeypatch.setattr(ur5, "RTDEControlInterface", Broken)
    monkeypatch.setattr(UR5, "_answers", lambda _: True)
    arm = UR5("127.0.0.1")
    arm.take_control(2.5)
    return arm


CALLS: dict[str, Callable[[UR5], object]] = {
    "tcp": UR5.flange_from_tcp,
    "motion": lambda arm: arm.move_linear(LinearMove(np.eye(4), 20.0, 50.0)),
    "sign of life": UR5.feed_watchdog,
}


@pytest.mark.hazard("H17")
@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_a_connection_that_breaks_amid_a_call_is_a_refusal_of_the_controller(
    arm: UR5, call: Callable[[UR5], object]
) -> None:
    with pytest.raises(ControllerRefusedError, match="Broken pipe"):
        call(arm)


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_without_control_nothing_is_asked_of_the_controller(call: Callable[[UR5], object]) -> None:
    with pytest.raises(ControllerRefusedError, match="no control script"):
        call(UR5("127.0.0.1"))


def test_control_without_an_armed_watchdog_is_none(arm: UR5, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Broken, "setWatchdog", lambda *_: False)
    with pytest.raises(ControllerRefusedError):
        arm.take_control(2.5)


class Words:
    """What the library read from the controller: an arm at rest, and these words."""

    def __init__(self, robot_status: int, runtime_state: int) -> None:
        self._words = {
            "RobotStatus": robot_status,
            "RuntimeState": runtime_state,
            "SafetyStatusBits": 1,
            "RobotMode": 7,
        }

    def __getattr__(self, name: str) -> Callable[[], object]:
        single = {**self._words, "Payload": 1.0}
        return lambda: single.get(name.removeprefix("get"), [0.0] * 6)


POWERED, PROGRAM, TEACHING = 1, 2, 4  # bits of the robot's status


@pytest.mark.parametrize(
    ("status", "runtime_state", "running"),
    [
        (POWERED, 1, False),
        (POWERED | TEACHING, 1, False),
        (POWERED | PROGRAM, 1, True),
        (POWERED, 2, True),
        (POWERED, 4, True),  # a paused program may go on
    ],
)
def test_a_program_runs_if_either_word_says_so(status: int, runtime_state: int, running: bool) -> None:
    state = ur5._state(Words(status, runtime_state), 0.0)
    assert (state.program_running, state.safety) == (running, SafetyState.NORMAL)
