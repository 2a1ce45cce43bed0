"""What ends a motion that is under way, and how the guard is left."""

from dataclasses import replace

import numpy as np
import pytest

from robot.errors import ControllerRefusedError
from robot.guard.messages import (
    BeginMove,
    EndCause,
    Fault,
    FaultKind,
    Heartbeat,
    MotionEnded,
    PendantReleased,
    Phase,
    ReleasePendant,
)
from robot.safety import SafetyState
from tests.robot.guarded_arm import Room, begin, ended


@pytest.mark.hazard("H21")
def test_readings_that_are_no_numbers_end_the_motion_however_well_the_button_is_held(
    room: Room, move: BeginMove
) -> None:
    begin(room, move)
    room.reading = replace(room.reading, tcp_speed_mm_s=np.nan)
    assert ended(room) is EndCause.FEEDBACK_LOST
    assert room.guard.phase is Phase.HELD


@pytest.mark.hazard("H16")
def test_silence_of_a_held_button_ends_the_motion_and_holds_the_guard(room: Room, move: BeginMove) -> None:
    begin(room, move)
    assert ended(room, held=False) is EndCause.HEARTBEAT_LOST
    assert room.guard.phase is Phase.HELD


def test_released_button_ends_the_motion_and_leaves_the_guard_idle(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.beat(2, held=False)
    assert ended(room, held=False) is EndCause.RELEASED
    assert room.guard.phase is Phase.IDLE


@pytest.mark.hazard("H16")
def test_hand_under_another_permit_takes_the_hold_away_and_is_no_release(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.guard.handle(Heartbeat("permit-0", 1, room.challenge(), held=False))
    assert ended(room) is EndCause.HEARTBEAT_LOST
    assert room.guard.phase is Phase.HELD


@pytest.mark.hazard("H20")
def test_watchdog_is_fed_once_for_each_new_live_heartbeat_and_by_nothing_else(room: Room, move: BeginMove) -> None:
    begin(room, move)
    before = room.orders.count("feed")
    for _ in range(5):
        room.turn()
    assert room.orders.count("feed") == before  # time alone feeds nothing
    challenge = room.challenge()
    room.beat(2, challenge)
    room.beat(2, challenge)
    assert room.orders.count("feed") == before + 1
    room.now_s += 0.3
    room.beat(3, challenge)  # a new number, held up on its way
    assert room.orders.count("feed") == before + 1


def test_watchdog_that_cannot_be_fed_ends_the_motion(room: Room, move: BeginMove) -> None:
    begin(room, move)

    def refuse() -> None:
        raise ControllerRefusedError("gone")

    room.feed_watchdog = refuse
    room.beat(2)
    for _ in range(40):
        room.turn()
    assert room.newest(MotionEnded).cause is EndCause.CONTROL_LOST


def test_stop_that_shows_no_effect_is_sent_again_until_it_does_or_time_is_up(room: Room, move: BeginMove) -> None:
    begin(room, move)

    def deaf() -> bool:
        room.orders.append("stop")
        return True

    room.send_stop = deaf  # the program goes on
    room.guard.handle(room.guard.stop_now("asked"))
    for _ in range(500):
        room.turn()
    ended = room.newest(MotionEnded)
    assert not ended.program_stopped
    assert 13 <= room.orders.count("stop") <= 18  # five a second for three seconds, and the first two
    assert room.guard.phase is Phase.HELD


def test_protective_stop_amid_a_release_is_told_beside_it_and_holds_the_guard(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.beat(2, held=False)
    room.turn()
    room.reading = replace(room.reading, safety=SafetyState.PROTECTIVE_STOP)
    for _ in range(40):
        room.turn()
    assert room.newest(MotionEnded).cause is EndCause.RELEASED
    assert room.newest(Fault).kind is FaultKind.PROTECTIVE_STOP
    assert room.guard.phase is Phase.HELD


def test_protective_stop_that_ended_a_motion_is_told_once(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.reading = replace(room.reading, safety=SafetyState.PROTECTIVE_STOP)
    for _ in range(40):
        room.turn()
    assert room.newest(MotionEnded).cause is EndCause.PROTECTIVE_STOP
    assert room.newest(Fault) is None
    assert room.guard.phase is Phase.HELD


def test_pendant_is_released_once_the_motion_is_over_and_stays_so(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.guard.handle(room.guard.stop_now("access"))
    room.guard.handle(ReleasePendant("access"))
    room.turn()
    assert room.newest(PendantReleased) is None  # the arm brakes
    for _ in range(40):
        room.turn()
    assert room.newest(PendantReleased).program_running is False
    assert room.orders[-2:] == ["give up", "release"]
    assert room.guard.phase is Phase.HELD


def test_broken_connection_ends_the_motion_and_the_guard_at_once(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.severed = True
    room.turn()
    assert room.orders[-1] == "stop"
    ended = room.newest(MotionEnded)
    assert (ended.cause, ended.at_rest, ended.program_stopped) == (EndCause.FEEDBACK_LOST, False, False)
    assert (room.guard.phase, room.guard.severed) == (Phase.HELD, True)


def test_stop_of_a_motion_that_is_ending_calmly_holds_the_guard(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.beat(2, held=False)
    room.turn()
    room.guard.handle(room.guard.stop_now("asked"))
    for _ in range(40):
        room.turn()
    assert room.newest(MotionEnded).cause is EndCause.RELEASED
    assert room.guard.phase is Phase.HELD


def test_release_that_the_controller_does_not_heed_holds_the_guard(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.send_stop = lambda: True  # the program goes on
    room.beat(2, held=False)
    for _ in range(500):
        room.turn()
    ended = room.newest(MotionEnded)
    assert (ended.cause, ended.program_stopped) == (EndCause.RELEASED, False)
    assert room.guard.phase is Phase.HELD
