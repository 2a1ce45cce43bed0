"""What happens while the guard takes control, which blocks it: no motion goes out after."""

from dataclasses import replace

import numpy as np
import pytest

from robot.errors import ControllerRefusedError
from robot.guard.messages import BeginMove, MoveRefused, Phase
from robot.refusal import RefusalCode
from robot.safety import SafetyState
from tests.robot.guarded_arm import Room, begin


def test_stop_that_comes_while_control_is_taken_prevents_the_motion(room: Room, move: BeginMove) -> None:
    sent = []
    room.while_control_is_taken = lambda: sent.append(room.guard.stop_now("asked"))  # from the other thread
    begin(room, move)  # the loop has not seen the stop yet
    assert "move" not in room.orders
    room.guard.handle(sent[0])
    assert room.newest(MoveRefused).refusal.code is RefusalCode.STOPPED
    room.turn()
    assert room.guard.phase is Phase.HELD
    assert "move" not in room.orders


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"safety": SafetyState.PROTECTIVE_STOP}, RefusalCode.ARM_NOT_READY),
        ({"joints_rad": np.deg2rad([0.5, -90.0, 90.0, -90.0, -90.0, 0.0])}, RefusalCode.ARM_MOVED_SINCE_PERMIT),
        ({"tcp_speed_mm_s": np.nan}, RefusalCode.ARM_UNREACHABLE),
    ],
)
def test_arm_that_changes_while_control_is_taken_is_not_moved(
    room: Room, move: BeginMove, change: dict[str, object], code: RefusalCode
) -> None:
    def happen() -> None:
        room.reading = replace(room.reading, **change)

    room.while_control_is_taken = happen
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is code
    assert "move" not in room.orders
    assert room.orders[-2:] == ["stop", "give up"]


def test_hold_let_go_while_control_is_taken_prevents_the_motion(room: Room, move: BeginMove) -> None:
    room.while_control_is_taken = lambda: room.beat(2, held=False)
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.NO_LIVE_HEARTBEAT
    assert "move" not in room.orders


def test_hold_that_was_not_heard_while_control_was_taken_is_awaited_but_not_for_long(
    room: Room, move: BeginMove
) -> None:
    def block() -> None:
        room.now_s += 0.3

    room.while_control_is_taken = block
    begin(room, move)
    assert room.guard.phase is Phase.STARTING
    room.turn()
    assert "move" not in room.orders
    room.turn(0.4)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.NO_LIVE_HEARTBEAT


def test_refused_tcp_stops_the_script_that_was_needed_to_read_it(room: Room, move: BeginMove) -> None:
    tcp = np.eye(4)
    tcp[0, 3] = 5.0
    begin(room, replace(move, flange_from_guide=tcp))
    assert room.newest(MoveRefused).refusal.code is RefusalCode.TCP_MISMATCH
    assert room.orders == ["control", "stop", "give up"]


def test_a_tcp_that_is_no_number_is_refused_and_can_be_told(room: Room, move: BeginMove) -> None:
    room.flange_from_tcp = lambda: np.full((4, 4), np.nan)
    begin(room, move)
    refusal = room.newest(MoveRefused).refusal
    assert (refusal.code, refusal.measured) == (RefusalCode.TCP_MISMATCH, None)
    assert "move" not in room.orders


def test_connection_that_breaks_before_the_motion_starts_nothing(room: Room, move: BeginMove) -> None:
    def break_off() -> None:
        room.severed = True

    room.while_control_is_taken = break_off
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.ARM_UNREACHABLE
    assert "move" not in room.orders
    assert room.guard.severed


@pytest.mark.hazard("H21")
def test_feedback_that_does_not_show_the_script_in_time_lets_nothing_begin(room: Room, move: BeginMove) -> None:
    """Late from its first packet on, it shows an arm that was, and still none of the script that runs."""

    def unseen() -> None:
        room.reading = replace(room.reading, program_running=False)

    room.while_control_is_taken = unseen
    begin(room, move)
    assert room.guard.phase is Phase.STARTING  # it may yet come
    for number in range(2, 30):
        room.beat(number)
        room.turn()
    refusal = room.newest(MoveRefused).refusal
    assert (refusal.code, refusal.limit) == (RefusalCode.FEEDBACK_LATE, 0.1)
    assert 0.1 < refusal.measured < 0.12
    assert "move" not in room.orders


def test_feedback_that_shows_the_script_a_moment_later_lets_the_motion_begin(room: Room, move: BeginMove) -> None:
    room.while_control_is_taken = lambda: setattr(room, "reading", replace(room.reading, program_running=False))
    begin(room, move)
    room.turn()
    assert "move" not in room.orders
    room.reading = replace(room.reading, program_running=True)
    room.turn()
    assert "move" in room.orders


@pytest.mark.hazard("H21")
@pytest.mark.parametrize("fails", [False, True])
def test_controller_that_answers_late_is_not_moved(room: Room, move: BeginMove, monkeypatch, fails: bool) -> None:
    def answer() -> np.ndarray:
        room.now_s += 0.21
        if fails:
            raise ControllerRefusedError("no answer")
        return np.eye(4)

    monkeypatch.setattr(room, "flange_from_tcp", answer)
    begin(room, move)
    refusal = room.newest(MoveRefused).refusal
    assert (refusal.code, refusal.limit) == (RefusalCode.FEEDBACK_LATE, 0.2)
    assert refusal.measured == pytest.approx(0.21)
    assert "move" not in room.orders
