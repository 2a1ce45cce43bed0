"""What ends a motion, or keeps it from beginning, at the edge: the last value that passes, and how often it takes."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robot.arm import ArmState
from robot.guard.deviation import PathWatch, TcpWatch
from robot.guard.feedback import FeedbackWatch, Verdict
from robot.guard.force import FORCE_RISE_N, ForceWatch, RestingForce, refuse_force
from robot.guard.messages import BeginMove, EndCause
from robot.guard.motion import ARRIVAL_REST_S, MotionJudge, is_at
from robot.guard.preflight import refuse_arm
from robot.guard.rest import REST_SPEED_MM_S, REST_TURN_RAD_S, DisplacementWatch, RestWatch, is_slow
from robot.kinematics import base_from_flange
from robot.refusal import RefusalCode

At = Callable[..., ArmState]
NO_FORCE_N = np.zeros(3)


def turned(pose: np.ndarray, angle_rad: float, axis: str = "z") -> np.ndarray:
    """A pose turned about its own origin."""
    other = pose.copy()
    other[:3, :3] = pose[:3, :3] @ Rotation.from_euler(axis, angle_rad).as_matrix()
    return other


def shifted(pose: np.ndarray, *offset_mm: float) -> np.ndarray:
    """A pose shifted in the base."""
    other = pose.copy()
    other[:3, 3] += offset_mm
    return other


def with_pose(reading: ArmState, base_from_tcp: np.ndarray) -> ArmState:
    return replace(reading, base_from_tcp=base_from_tcp)


@pytest.mark.parametrize(
    ("share", "aside_rad", "off"),
    [(0.0, 0.0, False), (0.5, 0.0, False), (1.0, 0.0, False), (0.5, 0.06, True), (0.5, 0.01, False), (1.1, 0.0, True)],
)
def test_an_approved_turn_is_followed_and_no_other(
    move: BeginMove, reading: ArmState, share: float, aside_rad: float, off: bool
) -> None:
    """The shortest turn of 0.3 rad; 0.01 rad aside of its middle is a detour of 0.0007 rad, 0.06 rad one of 0.024."""
    start = reading.base_from_tcp
    watch = PathWatch(replace(move, base_from_goal=turned(start, 0.3)), reading)
    now = with_pose(reading, turned(turned(start, 0.3 * share), aside_rad, "x"))
    assert [watch.is_off(now) for _ in range(3)] == [False, False, off]


def test_a_turn_on_the_spot_keeps_its_place(move: BeginMove, reading: ArmState) -> None:
    start = reading.base_from_tcp
    watch = PathWatch(replace(move, base_from_goal=turned(start, 0.3)), reading)
    away = with_pose(reading, shifted(turned(start, 0.15), 1.01, 0.0, 0.0))
    assert [watch.is_off(away) for _ in range(3)] == [False, False, True]


@pytest.mark.parametrize(
    ("x_mm", "y_mm", "off"), [(-0.9, 0.0, False), (-1.1, 0.0, True), (10.9, 0.0, False), (5.0, 1.1, True)]
)
def test_before_its_start_and_past_its_goal_a_way_is_as_narrow_as_beside_it(
    move: BeginMove, reading: ArmState, x_mm: float, y_mm: float, off: bool
) -> None:
    watch = PathWatch(move, reading)
    now = with_pose(reading, shifted(reading.base_from_tcp, x_mm, y_mm, 0.0))
    assert [watch.is_off(now) for _ in range(3)][-1] is off


def test_one_reading_on_the_way_forgives_those_before_it(move: BeginMove, reading: ArmState) -> None:
    watch, off = PathWatch(move, reading), with_pose(reading, shifted(reading.base_from_tcp, 0.0, 2.0, 0.0))
    assert [watch.is_off(now) for now in (off, off, reading, off, off, off)] == [False] * 5 + [True]


def test_another_tcp_shows_in_three_readings_in_a_row(move: BeginMove, reading: ArmState) -> None:
    watch, other = TcpWatch(move, reading), with_pose(reading, shifted(reading.base_from_tcp, 0.0, 0.0, 0.06))
    seen = [watch.has_changed(now) for now in (other, other, reading, other, other, other)]
    assert seen == [False] * 5 + [True]


@pytest.mark.parametrize(("angle_rad", "changed"), [(2.9e-4, False), (3.1e-4, True)])
def test_a_tcp_that_is_turned_is_another_one(
    move: BeginMove, reading: ArmState, angle_rad: float, changed: bool
) -> None:
    watch, now = TcpWatch(move, reading), with_pose(reading, turned(reading.base_from_tcp, angle_rad))
    assert [watch.has_changed(now) for _ in range(3)][-1] is changed


def test_a_pose_that_changes_long_after_the_start_of_the_clock_is_not_frozen(at: At) -> None:
    watch = FeedbackWatch()
    verdicts = {watch.take(at(100.0 + 0.01 * index, x_mm=0.1 * index, speed_mm_s=10.0)) for index in range(40)}
    assert verdicts == {Verdict.GOOD}


def test_no_force_is_known_before_the_arm_was_seen_at_rest(at: At) -> None:
    force = RestingForce()
    force.observe(replace(at(0.0, speed_mm_s=5.0), tcp_force_n=np.full(3, 9.0)))
    assert force.newest_n is None
    refusal = refuse_force(force.newest_n)
    assert (refusal.code, refusal.measured, refusal.limit) == (RefusalCode.FORCE_AT_REST, None, FORCE_RISE_N)


def test_the_force_at_rest_is_the_mean_of_the_newest_fifth_of_a_second(at: At) -> None:
    force = RestingForce()
    for felt_n in [100.0] + [1.0] * 24 + [27.0]:
        force.observe(replace(at(0.0), tcp_force_n=np.array([felt_n, 0.0, 0.0])))
    assert force.newest_n == pytest.approx([(24.0 + 27.0) / 25.0, 0.0, 0.0])


@pytest.mark.parametrize(("force_n", "refused"), [(30.0, False), (30.001, True)])
def test_a_motion_may_begin_at_the_limit_of_the_force(force_n: float, refused: bool) -> None:
    assert (refuse_force(np.array([0.0, force_n, 0.0])) is not None) is refused


@pytest.mark.parametrize(("count", "risen_n"), [(2, 0.0), (3, 31.0)])
def test_a_rise_counts_from_its_third_reading(at: At, count: int, risen_n: float) -> None:
    watch, pressed = ForceWatch(NO_FORCE_N), replace(at(0.0), tcp_force_n=np.array([0.0, 31.0, 0.0]))
    assert [watch.observe(pressed) for _ in range(count)][-1] == risen_n


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        ({"tcp_force_n": np.array([0.0, 0.0, FORCE_RISE_N])}, None),
        ({"speed_mm_s": 25.0}, None),  # 1.25 times the cap
        ({"speed_mm_s": 25.001}, EndCause.OVERSPEED),
        ({"tcp_turn_speed_rad_s": 1.25 * np.deg2rad(5.0)}, None),
        ({"program_running": False}, EndCause.CONTROL_LOST),
    ],
)
def test_a_motion_goes_on_at_its_limits(
    move: BeginMove, at: At, change: dict[str, Any], cause: EndCause | None
) -> None:
    judge = MotionJudge(move, at(0.0), NO_FORCE_N, 0.0)
    readings = [at(0.008 * index, x_mm=0.2 * index, **{"speed_mm_s": 10.0, **change}) for index in range(1, 6)]
    assert [judge.judge(reading) for reading in readings][:3] == [None, None, cause]


@pytest.mark.parametrize("change", [{"speed_mm_s": 26.0}, {"program_running": False}])
def test_two_bad_readings_with_a_good_one_between_end_nothing(move: BeginMove, at: At, change: dict[str, Any]) -> None:
    judge = MotionJudge(move, at(0.0), NO_FORCE_N, 0.0)
    for index in range(1, 30):
        bad = change if index % 3 else {}
        assert judge.judge(at(0.008 * index, x_mm=0.2 * index, **{"speed_mm_s": 10.0, **bad})) is None


def test_the_times_of_a_motion_pass_at_their_limits(move: BeginMove, at: At) -> None:
    waiting = MotionJudge(move, at(0.0), NO_FORCE_N, 0.0)
    assert [waiting.judge(at(time_s)) for time_s in (0.3, 0.301)] == [None, EndCause.NOT_STARTED]
    slow = MotionJudge(move, at(0.0), NO_FORCE_N, 0.0)
    overdue_s = 4.0 * move.duration_s + 5.0
    ends = [slow.judge(at(time_s, x_mm=5.0, speed_mm_s=1.0)) for time_s in (overdue_s, overdue_s + 0.001)]
    assert ends == [None, EndCause.OVERDUE]
    there = MotionJudge(move, at(0.0), NO_FORCE_N, 0.0)
    ends = [there.judge(at(time_s, x_mm=10.0)) for time_s in (1.0, 1.0 + ARRIVAL_REST_S - 0.01, 1.0 + ARRIVAL_REST_S)]
    assert ends == [None, None, EndCause.ARRIVED]


def test_a_motion_that_only_turns_departs_and_arrives(move: BeginMove, at: At) -> None:
    start = at(0.0)
    goal = replace(move, base_from_goal=turned(start.base_from_tcp, 0.1))
    assert not is_at(start, goal)
    assert is_at(with_pose(start, turned(start.base_from_tcp, 0.1 - 8e-4)), goal)
    assert not is_at(with_pose(start, turned(start.base_from_tcp, 0.1 - 9e-4)), goal)
    joints_rad = start.joints_rad + 0.1 * np.eye(6)[5]
    turning = replace(move, base_from_goal=base_from_flange(joints_rad))
    judge = MotionJudge(turning, start, NO_FORCE_N, 0.0)
    for share in range(1, 41):
        joints_rad = start.joints_rad + 0.1 * share / 40.0 * np.eye(6)[5]
        reading = replace(at(0.008 * share), joints_rad=joints_rad, base_from_tcp=base_from_flange(joints_rad))
        assert judge.judge(replace(reading, tcp_turn_speed_rad_s=0.05)) is None


@pytest.mark.parametrize(
    ("speed_mm_s", "turn_rad_s", "slow"),
    [
        (REST_SPEED_MM_S, 0.0, False),
        (0.0, REST_TURN_RAD_S, False),
        (0.999 * REST_SPEED_MM_S, 0.999 * REST_TURN_RAD_S, True),
    ],
)
def test_noise_ends_where_a_speed_begins(at: At, speed_mm_s: float, turn_rad_s: float, slow: bool) -> None:
    assert is_slow(at(0.0, speed_mm_s=speed_mm_s, tcp_turn_speed_rad_s=turn_rad_s)) is slow


def test_an_arm_that_turns_slowly_is_not_at_rest(at: At) -> None:
    watch, start = RestWatch(), at(0.0).base_from_tcp
    rests = [watch.observe(with_pose(at(0.1 * step), turned(start, 1e-4 * step))) for step in range(10)]
    assert max(rests) < 0.15  # 0.01 deg is passed with the second step


def test_rest_begins_anew_after_a_motion_to_the_same_place(at: At) -> None:
    watch = RestWatch()
    assert [watch.observe(at(1.0)), watch.observe(at(2.0))] == [0.0, 1.0]
    assert watch.observe(at(3.0, speed_mm_s=5.0)) == 0.0
    assert [watch.observe(at(4.0)), watch.observe(at(4.5))] == [0.0, 0.5]


@pytest.mark.hazard("H04")
def test_an_arm_that_was_turned_is_told_once_when_the_moment_is_over(at: At) -> None:
    watch, start = DisplacementWatch(), at(0.0).base_from_tcp
    watch.observe(at(0.0))
    there = turned(start, 4e-4)  # above 0.02 deg
    told = [watch.observe(with_pose(at(time_s), there)) for time_s in (1.0, 1.0625, 1.125, 2.0, 3.0)]
    assert [one is None for one in told] == [True, True, False, True, True]
    assert (told[2].at_s, told[2].offset_mm) == (1.0, 0.0)
    assert told[2].angle_rad == pytest.approx(4e-4, rel=1e-3)


@pytest.mark.hazard("H04")
def test_a_displacement_after_one_that_was_told_is_measured_by_itself(at: At) -> None:
    watch = DisplacementWatch()
    told = [watch.observe(at(0.2 * step, x_mm=x_mm)) for step, x_mm in enumerate((0.0, 0.5, 0.5, 0.7, 0.7))]
    assert [one and round(one.offset_mm, 6) for one in told] == [None, None, 0.5, None, 0.2]


def test_nothing_is_displaced_from_a_place_that_nobody_saw(at: At) -> None:
    watch = DisplacementWatch()
    watch.observe(at(0.0))
    watch.account(None)
    assert [watch.observe(at(1.0 + 0.2 * step, x_mm=50.0)) for step in range(4)] == [None] * 4


@pytest.mark.hazard("H04")
def test_the_place_that_a_permit_binds_is_the_guide_s(move: BeginMove, reading: ArmState) -> None:
    """A wrist turned by 0.02 deg less a little moves a guide 200 mm away by 0.07 mm, and the flange by nothing."""
    far = np.eye(4)
    far[0, 3] = 200.0
    now = replace(reading, joints_rad=reading.joints_rad + 3.4e-4 * np.eye(6)[5])
    assert refuse_arm(replace(move, flange_from_guide=np.eye(4)), now) is None
    refusal = refuse_arm(replace(move, flange_from_guide=far), now)
    assert (refusal.code, refusal.limit) == (RefusalCode.ARM_MOVED_SINCE_PERMIT, 0.05)
    assert refusal.measured == pytest.approx(200.0 * 3.4e-4, rel=1e-3)
