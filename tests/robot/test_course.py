"""One motion by itself, over an arm of numbers: control, the order, what is told of it, and its end."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from robot.arm import ArmState, LinearMove
from robot.errors import ControllerRefusedError
from robot.guard.course import WATCHDOG_HZ, Course
from robot.guard.messages import BeginMove, EndCause, MotionEnded, MotionStarted, Phase
from robot.refusal import Refusal, RefusalCode


class Arm:
    """Does what it is told, or refuses it; a stop is written or not."""

    def __init__(self, clock: SimpleNamespace) -> None:
        self.clock = clock
        self.orders: list[object] = []
        self.refuses: set[str] = set()
        self.tcp = np.eye(4)
        self.stop_is_written = True

    def take_control(self, watchdog_hz: float) -> None:
        self._do("take_control", watchdog_hz)
        self.clock.now_s += 0.25  # it blocks

    def flange_from_tcp(self) -> np.ndarray:
        return self.tcp

    def move_linear(self, move: LinearMove) -> None:
        self._do("move_linear", move)

    def feed_watchdog(self) -> None:
        self._do("feed_watchdog", None)

    def stop_script(self) -> None:
        self.orders.append("script")

    def send_stop(self) -> bool:
        self.orders.append("stop")
        return self.stop_is_written

    def _do(self, name: str, order: object) -> None:
        if name in self.refuses:
            raise ControllerRefusedError(name)
        self.orders.append(order)


def along_z(offset_mm: float) -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = offset_mm
    return pose


@pytest.fixture
def clock() -> SimpleNamespace:
    return SimpleNamespace(now_s=64.0)


@pytest.fixture
def arm(clock: SimpleNamespace) -> Arm:
    return Arm(clock)


@pytest.fixture
def recorded() -> list[tuple[str, ArmState]]:
    return []


@pytest.fixture
def course(
    move: BeginMove, reading: ArmState, arm: Arm, clock: SimpleNamespace, recorded: list[tuple[str, ArmState]]
) -> Course:
    journal = SimpleNamespace(sample=lambda permit_id, reading: recorded.append((permit_id, reading)))
    return Course(move, reading, arm, journal, lambda: clock.now_s)


@pytest.fixture
def moving(course: Course, arm: Arm, reading: ArmState) -> Course:
    """The same, control taken and put on the wire."""
    assert course.take_control() is None
    assert isinstance(course.launch(reading, np.zeros(3)), MotionStarted)
    arm.orders.clear()
    return course


def test_control_is_counted_from_when_it_was_taken(course: Course, arm: Arm) -> None:
    assert course.controlled_at_s == 64.0
    assert course.take_control() is None
    assert arm.orders == [WATCHDOG_HZ]
    assert course.controlled_at_s == 64.25
    assert course.phase is Phase.STARTING


def test_control_that_is_refused_is_a_refusal(course: Course, arm: Arm) -> None:
    arm.refuses = {"take_control"}
    assert course.take_control() == Refusal(RefusalCode.CONTROLLER_REFUSED, "take_control", None, None)


def test_another_tcp_than_the_calibrated_one_is_refused(course: Course, arm: Arm) -> None:
    arm.tcp = along_z(0.06)
    assert course.take_control().code is RefusalCode.TCP_MISMATCH


def test_what_is_put_on_the_wire_is_told_as_the_controller_reports_it(
    course: Course, arm: Arm, move: BeginMove, reading: ArmState
) -> None:
    arm.tcp = along_z(0.04)
    course.take_control()
    told = course.launch(reading, np.zeros(3))
    order = arm.orders[-1]
    assert np.array_equal(order.base_from_goal, move.base_from_goal)
    assert (order.speed_mm_s, order.acceleration_mm_s2) == (20.0, 50.0)
    assert course.phase is Phase.MOVING
    assert (told.permit_id, told.at_s, told.payload_kg) == ("permit-1", 64.25, 1.0)
    assert told.base_from_start is reading.base_from_tcp
    assert told.joints_rad is reading.joints_rad
    assert told.payload_centre_mm is reading.payload_centre_mm
    assert np.array_equal(told.flange_from_tcp, arm.tcp)


@pytest.mark.hazard("H10")
def test_a_tcp_that_is_changed_once_it_was_told_moves_nothing(course: Course, arm: Arm, reading: ArmState) -> None:
    course.take_control()
    answer = course.launch(replace(reading, base_from_tcp=reading.base_from_tcp @ along_z(0.06)), np.zeros(3))
    assert isinstance(answer, Refusal)
    assert answer.code is RefusalCode.TCP_MISMATCH
    assert arm.orders == [WATCHDOG_HZ]


def test_a_motion_that_was_asked_for_unseen_moves_nothing(move: BeginMove, arm: Arm, reading: ArmState) -> None:
    course = Course(move, None, arm, SimpleNamespace(), lambda: 64.0)
    course.take_control()
    assert isinstance(course.launch(reading, np.zeros(3)), Refusal)


def test_an_order_that_the_controller_refuses_moves_nothing(course: Course, arm: Arm, reading: ArmState) -> None:
    course.take_control()
    arm.refuses = {"move_linear"}
    assert course.launch(reading, np.zeros(3)) == Refusal(RefusalCode.CONTROLLER_REFUSED, "move_linear", None, None)
    assert course.phase is Phase.STARTING


def test_a_watchdog_that_is_not_fed_is_lost_control(course: Course, arm: Arm) -> None:
    assert course.feed_watchdog() is None
    arm.refuses = {"feed_watchdog"}
    assert course.feed_watchdog() is EndCause.CONTROL_LOST


def test_readings_are_recorded_throughout_and_judged_while_it_moves(
    course: Course, recorded: list[tuple[str, ArmState]], reading: ArmState
) -> None:
    pressed = replace(reading, payload_kg=9.0, program_running=True)
    assert course.observe(pressed) is None  # not yet on the wire
    course.take_control()
    course.launch(reading, np.zeros(3))
    assert course.observe(pressed) is EndCause.PAYLOAD_CHANGED
    course.stop(EndCause.PAYLOAD_CHANGED)
    assert course.observe(pressed) is None
    assert recorded == [("permit-1", pressed)] * 3
    assert course.abandon(None).trajectory_samples == 3


def test_the_first_cause_to_end_it_counts(moving: Course, arm: Arm, reading: ArmState) -> None:
    moving.stop(EndCause.FORCE_RISE)
    moving.stop(EndCause.STOPPED)
    assert moving.phase is Phase.STOPPING
    assert arm.orders == ["script", "stop"]  # what does not wait goes first
    assert moving.abandon(reading).cause is EndCause.FORCE_RISE


@pytest.mark.parametrize(
    ("sent_at_s", "written", "told_s"),
    [(60.0, True, 60.0), (60.0, False, 60.0), (None, True, 64.25), (None, False, None)],
)
def test_the_first_stop_that_was_written_is_told(
    moving: Course, arm: Arm, sent_at_s: float | None, written: bool, told_s: float | None
) -> None:
    arm.stop_is_written = written
    moving.stop(EndCause.STOPPED, sent_at_s)
    assert moving.abandon(None).stop_sent_at_s == told_s


def test_a_stop_that_could_not_be_written_is_told_when_it_could(
    moving: Course, arm: Arm, clock: SimpleNamespace
) -> None:
    arm.stop_is_written = False
    moving.stop(EndCause.STOPPED)
    arm.stop_is_written = True
    for clock.now_s in (65.0, 66.0):
        assert moving.settle(None, sound=True, rest_s=0.0) is None
    assert moving.abandon(None).stop_sent_at_s == 65.0


@pytest.mark.parametrize(
    ("sound", "seen", "rest_s", "program_running", "waited_s", "at_rest", "over"),
    [
        (True, True, 0.15, False, 0.15, True, True),
        (True, True, 0.14, False, 0.15, None, None),
        (True, True, 9.0, False, 0.14, None, None),  # it rested before, perhaps before it began to move
        (True, True, 0.15, True, 0.15, None, None),  # a program could go on
        (True, True, 0.0, False, 3.0, None, None),
        (True, True, 0.0, False, 3.001, False, False),
        (True, True, 0.15, True, 3.001, True, False),
        (True, False, 0.15, False, 0.15, None, None),
        (False, True, 0.15, False, 0.5, None, None),  # blind, though it was seen at rest before
        (False, True, 0.15, False, 0.501, False, False),
        (False, False, 0.0, False, 0.501, False, False),
    ],
)
def test_it_is_over_at_rest_without_a_program_or_when_its_time_is_up(
    moving: Course,
    clock: SimpleNamespace,
    reading: ArmState,
    sound: bool,
    seen: bool,
    rest_s: float,
    program_running: bool,
    waited_s: float,
    at_rest: bool | None,
    over: bool | None,
) -> None:
    clock.now_s = 0.0  # so that the waits are exact
    moving.stop(EndCause.STOPPED)
    clock.now_s = waited_s
    newest = replace(reading, program_running=program_running) if seen else None
    ended = moving.settle(newest, sound, rest_s)
    assert (ended and ended.at_rest, ended and ended.program_stopped) == (at_rest, over)


def test_a_stop_without_effect_is_sent_again_five_times_a_second(
    moving: Course, arm: Arm, clock: SimpleNamespace
) -> None:
    clock.now_s = 0.0
    moving.stop(EndCause.STOPPED)
    sent = []
    for clock.now_s in (0.1, 0.2, 0.21, 0.3, 0.41, 0.42):
        before = arm.orders.count("stop")
        moving.settle(None, sound=True, rest_s=0.0)
        sent.append(arm.orders.count("stop") - before)
    assert sent == [0, 0, 1, 0, 0, 1]


def test_the_end_is_told_whole(moving: Course, clock: SimpleNamespace, reading: ArmState) -> None:
    moving.stop(EndCause.RELEASED)
    clock.now_s += 0.2
    ended = moving.settle(reading, sound=True, rest_s=0.2)
    assert isinstance(ended, MotionEnded)
    assert (ended.permit_id, ended.at_s, ended.arm) == ("permit-1", 64.45, reading)
    assert (ended.distance_mm, ended.angle_rad) == pytest.approx((10.0, 0.0))
    assert ended.trajectory_file == "trajectory-permit-1.jsonl"


def test_an_end_that_nobody_saw_says_so(moving: Course) -> None:
    ended = moving.abandon(None)
    assert (ended.distance_mm, ended.angle_rad, ended.arm) == (None, None, None)
    assert (ended.cause, ended.at_rest, ended.program_stopped) == (EndCause.STOPPED, False, False)
