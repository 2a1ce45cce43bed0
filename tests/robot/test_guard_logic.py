"""The guard's order of things with an arm of numbers and a clock that is turned by hand."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robot.arm import ArmState, LinearMove
from robot.errors import ControllerRefusedError
from robot.guard.guard import Guard
from robot.guard.journal import EVENTS_FILE, Journal
from robot.guard.messages import (
    Acknowledge,
    BeginMove,
    EndCause,
    Event,
    Fault,
    FaultKind,
    Heartbeat,
    MotionEnded,
    MoveRefused,
    PendantReleased,
    Phase,
    ReleasePendant,
    Status,
)
from robot.refusal import RefusalCode
from robot.safety import SafetyState

TURN_S = 0.008


class Room:
    """An arm that does what it is told, a guard over it, and the time."""

    def __init__(self, reading: ArmState, journal: Journal) -> None:
        self.now_s = 100.0
        self.reading = reading
        self.orders: list[str] = []
        self.events: list[Event] = []
        self.journal = journal
        self.severed = False
        self.while_control_is_taken: Callable[[], None] = lambda: None
        self.guard = Guard(self, journal, self.events.append, lambda: self.now_s)
        self.turn()
        self.guard.handle(Acknowledge())

    def turn(self, seconds: float = TURN_S) -> None:
        """Let time pass and the guard have a look."""
        self.now_s += seconds
        self.guard.tick()

    def beat(self, number: int, challenge: str | None = None, held: bool = True) -> None:
        self.guard.handle(Heartbeat("permit-1", number, challenge or self.challenge(), held))

    def challenge(self) -> str:
        return next(event.challenge for event in reversed(self.events) if isinstance(event, Status))

    def newest(self, kind: type[Event]) -> Event | None:
        return next((event for event in reversed(self.events) if isinstance(event, kind)), None)

    # What follows is the Arm protocol.

    def read(self) -> ArmState:
        return replace(self.reading, controller_time_s=self.now_s, received_at_s=self.now_s)

    def connect(self) -> bool:
        return True

    def take_control(self, watchdog_hz: float) -> None:
        self.orders.append("control")
        self.reading = replace(self.reading, program_running=True)
        self.while_control_is_taken()

    def flange_from_tcp(self) -> np.ndarray:
        return np.eye(4)

    def move_linear(self, move: LinearMove) -> None:
        self.orders.append("move")

    def feed_watchdog(self) -> None:
        self.orders.append("feed")

    def send_stop(self) -> bool:
        self.orders.append("stop")
        self.reading = replace(self.reading, program_running=False)
        return True

    def stop_script(self) -> None:
        self.orders.append("stop script")

    def give_up_control(self) -> None:
        self.orders.append("give up")

    def release_pendant(self) -> None:
        self.orders.append("release")

    def is_severed(self) -> bool:
        return self.severed

    def is_stuck(self) -> bool:
        return False

    def close(self) -> None:
        pass


@pytest.fixture
def room(reading: ArmState, tmp_path: Path):
    journal = Journal(tmp_path)
    yield Room(reading, journal)
    journal.close()


def begin(room: Room, move: BeginMove) -> None:
    room.turn(0.03)
    room.beat(1)
    room.guard.handle(move)
    room.turn()


def test_motion_goes_out_once_control_is_taken_and_everything_still_holds(room: Room, move: BeginMove) -> None:
    begin(room, move)
    assert room.orders == ["control", "move"]
    assert room.guard.phase is Phase.MOVING


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


def ended(room: Room, within_s: float = 2.0, *, held: bool = True) -> EndCause:
    """Turn until the motion is over, the button held on or not: why it ended."""
    end_s, number = room.now_s + within_s, 1
    while room.newest(MotionEnded) is None:
        assert room.now_s < end_s, "the motion goes on"
        number += 1
        if held:
            room.beat(number)
        room.turn()
    return room.newest(MotionEnded).cause


@pytest.mark.hazard("H14")
def test_permit_is_spent_by_its_first_motion_whatever_came_of_it(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.guard.handle(room.guard.stop_now("asked"))
    assert ended(room) is EndCause.STOPPED
    room.guard.handle(Acknowledge())
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.PERMIT_REUSED
    assert room.orders.count("move") == 1


@pytest.mark.hazard("H14")
def test_second_motion_is_refused_while_one_runs_which_goes_on(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.guard.handle(replace(move, permit_id="permit-2"))
    assert room.newest(MoveRefused).refusal.code is RefusalCode.MOTION_RUNNING
    assert room.guard.phase is Phase.MOVING


@pytest.mark.hazard("H18")
def test_held_guard_starts_nothing_before_an_acknowledgement(room: Room, move: BeginMove) -> None:
    room.guard.handle(room.guard.stop_now("asked"))
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.GUARD_HELD
    assert "move" not in room.orders


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


def ahead(move: BeginMove, offset_mm: float, turn_deg: float = 0.0) -> np.ndarray:
    goal = move.base_from_goal.copy()
    goal[0, 3] += offset_mm - 10.0  # the move's own way
    goal[:3, :3] = goal[:3, :3] @ Rotation.from_euler("x", turn_deg, degrees=True).as_matrix()
    return goal


@pytest.mark.hazard("H12")
@pytest.mark.parametrize(
    ("change", "code", "limit"),
    [
        ({"speed_mm_s": 20.001}, RefusalCode.SPEED_ABOVE_CAP, 20.0),
        ({"acceleration_mm_s2": 50.001}, RefusalCode.ACCELERATION_ABOVE_CAP, 50.0),
        ({"way": (150.1, 0.0)}, RefusalCode.MOVE_TOO_FAR, 150.0),
        ({"way": (0.0, 35.1)}, RefusalCode.MOVE_TOO_FAR, np.deg2rad(35.0)),
    ],
)
def test_guard_holds_to_its_own_caps_whatever_was_planned_and_approved(
    room: Room, move: BeginMove, change: dict[str, Any], code: RefusalCode, limit: float
) -> None:
    goal = {"base_from_goal": ahead(move, *change.pop("way"))} if "way" in change else {}
    begin(room, replace(move, **change, **goal))
    refusal = room.newest(MoveRefused).refusal
    assert (refusal.code, refusal.limit) == (code, limit)
    assert refusal.measured > limit
    assert room.orders == []  # not one packet


def test_motion_at_every_cap_is_allowed(room: Room, move: BeginMove) -> None:
    begin(room, replace(move, speed_mm_s=20.0, acceleration_mm_s2=50.0, base_from_goal=ahead(move, 150.0, 35.0)))
    assert room.orders == ["control", "move"]


@pytest.mark.hazard("H12")
def test_motion_against_something_that_presses_already_is_refused(room: Room, move: BeginMove) -> None:
    room.reading = replace(room.reading, tcp_force_n=np.array([0.0, 31.0, 0.0]))
    for _ in range(30):
        room.turn()
    begin(room, move)
    refusal = room.newest(MoveRefused).refusal
    assert (refusal.code, refusal.limit) == (RefusalCode.FORCE_AT_REST, 30.0)
    assert refusal.measured == pytest.approx(31.0)
    assert room.orders == []


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


def test_connection_that_breaks_before_the_motion_starts_nothing(room: Room, move: BeginMove) -> None:
    def break_off() -> None:
        room.severed = True

    room.while_control_is_taken = break_off
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.ARM_UNREACHABLE
    assert "move" not in room.orders
    assert room.guard.severed


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


@pytest.mark.hazard("H24")
def test_motion_whose_intent_cannot_be_written_does_not_go_out(room: Room, move: BeginMove, tmp_path: Path) -> None:
    assert room.journal.flush(5.0)  # all before it was written
    (tmp_path / EVENTS_FILE).unlink()
    (tmp_path / EVENTS_FILE).symlink_to("/dev/full")
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.JOURNAL_UNWRITABLE
    assert room.orders == []
