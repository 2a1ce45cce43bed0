"""When a motion ends and why, as pure logic."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from robot.arm import ArmState
from robot.guard.messages import BeginMove, EndCause
from robot.guard.motion import MotionJudge
from robot.guard.preflight import refuse_arm, refuse_tcp
from robot.kinematics import base_from_flange
from robot.refusal import RefusalCode
from robot.safety import SafetyState

At = Callable[..., ArmState]
CYCLE_S = 0.008


def travel(at: At, to_mm: float, rest_s: float) -> Iterator[ArmState]:
    """Readings of an arm that runs at 20 mm/s to a place and rests there."""
    steps = int(to_mm / 20.0 / CYCLE_S)
    for index in range(1, steps + 1):
        yield at(index * CYCLE_S, x_mm=index * to_mm / steps, speed_mm_s=20.0)
    for index in range(int(rest_s / CYCLE_S)):
        yield at((steps + 1 + index) * CYCLE_S, x_mm=to_mm)


def verdict(judge: MotionJudge, readings: Iterator[ArmState]) -> tuple[EndCause | None, float]:
    for reading in readings:
        cause = judge.judge(reading)
        if cause is not None:
            return cause, reading.received_at_s
    return None, 0.0


@pytest.fixture
def judge(move: BeginMove, at: At) -> MotionJudge:
    return MotionJudge(move, at(0.0), np.zeros(3), 0.0)


def test_arrival_is_half_a_second_of_rest_at_the_goal(judge: MotionJudge, at: At) -> None:
    cause, time_s = verdict(judge, travel(at, 10.0, 2.0))
    assert cause is EndCause.ARRIVED
    assert time_s == pytest.approx(0.5 + 0.5, abs=3 * CYCLE_S)


@pytest.mark.parametrize(("x_mm", "cause"), [(9.92, EndCause.ARRIVED), (9.85, EndCause.MISSED), (5.0, EndCause.MISSED)])
def test_rest_elsewhere_is_a_miss(judge: MotionJudge, at: At, x_mm: float, cause: EndCause) -> None:
    assert verdict(judge, travel(at, x_mm, 2.0))[0] is cause


def test_arm_that_does_not_leave_is_noticed_within_a_third_of_a_second(judge: MotionJudge, at: At) -> None:
    cause, time_s = verdict(judge, (at(index * CYCLE_S) for index in range(1000)))
    assert cause is EndCause.NOT_STARTED
    assert time_s < 0.33


def test_goal_where_the_arm_already_is_is_reached_without_departing(move: BeginMove, at: At) -> None:
    here = replace(move, base_from_goal=at(0.0).base_from_tcp)
    cause, _ = verdict(MotionJudge(here, at(0.0), np.zeros(3), 0.0), (at(index * CYCLE_S) for index in range(1000)))
    assert cause is EndCause.ARRIVED


@pytest.mark.parametrize(
    ("safety", "cause"),
    [
        (SafetyState.PROTECTIVE_STOP, EndCause.PROTECTIVE_STOP),
        (SafetyState.SAFEGUARD_STOP, EndCause.SAFEGUARD_STOP),
        (SafetyState.EMERGENCY_STOP, EndCause.EMERGENCY_STOP),
        (SafetyState.OFF, EndCause.ARM_OFF),
        (SafetyState.VIOLATION, EndCause.SAFETY_FAULT),
        (SafetyState.FAULT, EndCause.SAFETY_FAULT),
        (SafetyState.RECOVERY, EndCause.SAFETY_FAULT),
    ],
)
def test_the_first_reading_of_a_stop_ends_the_motion(
    judge: MotionJudge, at: At, safety: SafetyState, cause: EndCause
) -> None:
    assert judge.judge(at(0.1, x_mm=1.0, speed_mm_s=10.0, safety=safety)) is cause


def test_reduced_mode_ends_nothing(judge: MotionJudge, at: At) -> None:
    assert judge.judge(at(0.1, x_mm=1.0, speed_mm_s=10.0, safety=SafetyState.REDUCED)) is None


@pytest.mark.hazard("H12")
@pytest.mark.parametrize("fast", [{"speed_mm_s": 26.0}, {"speed_mm_s": 10.0, "tcp_turn_speed_rad_s": 0.12}])
def test_three_readings_above_a_cap_end_the_motion(judge: MotionJudge, at: At, fast: dict[str, float]) -> None:
    causes = [judge.judge(at(0.1 + index * CYCLE_S, x_mm=1.0 + index, **fast)) for index in range(3)]
    assert causes == [None, None, EndCause.OVERSPEED]


def test_program_that_vanishes_is_lost_control(judge: MotionJudge, at: At) -> None:
    readings = (
        at(0.1 + index * CYCLE_S, x_mm=1.0 + index, speed_mm_s=15.0, program_running=False) for index in (0, 1, 2)
    )
    assert verdict(judge, readings)[0] is EndCause.CONTROL_LOST


def after(at: At, count: int, **changes: object) -> Iterator[ArmState]:
    """Readings of a calm motion that change after its first tenth of a second."""
    for index in range(1, 13 + count):
        time_s = index * CYCLE_S
        yield at(time_s, x_mm=10.0 * time_s, speed_mm_s=10.0, **(changes if index > 12 else {}))


@pytest.mark.hazard("H12")
@pytest.mark.parametrize("force_n", [[31.0, 0.0, 0.0], [0.0, 0.0, -31.0], [18.0, 18.0, 18.0]])
def test_force_that_rises_ends_the_motion_within_three_readings(judge: MotionJudge, at: At, force_n: list) -> None:
    cause, time_s = verdict(judge, after(at, 3, tcp_force_n=np.array(force_n)))
    assert cause is EndCause.FORCE_RISE
    assert time_s == pytest.approx(15 * CYCLE_S)


def test_force_that_was_there_before_the_motion_is_no_rise(move: BeginMove, at: At) -> None:
    weight_n = np.array([0.0, 0.0, -25.0])
    judge = MotionJudge(move, at(0.0), weight_n, 0.0)
    felt_n = weight_n + 29.0 * np.array([0.0, 1.0, 0.0])
    assert verdict(judge, (replace(reading, tcp_force_n=felt_n) for reading in after(at, 20)))[0] is None


def test_spike_of_two_readings_is_no_force(judge: MotionJudge, at: At) -> None:
    assert verdict(judge, after(at, 2, tcp_force_n=np.array([0.0, 0.0, 500.0])))[0] is None
    assert judge.judge(at(0.2, x_mm=2.0, speed_mm_s=10.0)) is None


@pytest.mark.hazard("H10")
@pytest.mark.parametrize("change", [{"payload_kg": 1.1}, {"payload_centre_mm": np.array([0.0, 0.0, 56.0])}])
def test_payload_that_changes_amid_the_motion_ends_it(judge: MotionJudge, at: At, change: dict[str, Any]) -> None:
    assert verdict(judge, after(at, 1, **change))[0] is EndCause.PAYLOAD_CHANGED


@pytest.mark.hazard("H10")
@pytest.mark.parametrize(("tcp_mm", "cause"), [(0.1, EndCause.TCP_CHANGED), (5.0, EndCause.TCP_CHANGED), (0.04, None)])
def test_pose_that_leaps_without_the_joints_is_another_tcp(
    judge: MotionJudge, at: At, tcp_mm: float, cause: EndCause | None
) -> None:
    def other(reading: ArmState) -> ArmState:
        pose = reading.base_from_tcp.copy()
        pose[:3, 3] += tcp_mm * pose[:3, 0]
        return replace(reading, base_from_tcp=pose)

    readings = [reading if index < 12 else other(reading) for index, reading in enumerate(after(at, 5))]
    assert verdict(judge, iter(readings))[0] is cause


def test_model_that_is_off_by_a_millimetre_on_a_calibrated_arm_is_no_other_tcp(move: BeginMove, at: At) -> None:
    def calibrated(reading: ArmState) -> ArmState:
        """A mismatch of 1 mm that changes by 0.3 mm along 10 mm, thirty times what a calibration does."""
        pose = reading.base_from_tcp.copy()
        pose[1, 3] += 1.0 + 0.03 * (pose[0, 3] - at(0.0).base_from_tcp[0, 3])
        return replace(reading, base_from_tcp=pose)

    goal = move.base_from_goal.copy()
    goal[1, 3] += 1.3
    judge = MotionJudge(replace(move, base_from_goal=goal), calibrated(at(0.0)), np.zeros(3), 0.0)
    assert verdict(judge, map(calibrated, travel(at, 10.0, 2.0)))[0] is EndCause.ARRIVED


@pytest.mark.parametrize(("y_mm", "cause"), [(0.9, None), (1.1, EndCause.OFF_PATH)])
def test_arm_that_leaves_its_line_is_stopped(judge: MotionJudge, at: At, y_mm: float, cause: EndCause | None) -> None:
    assert verdict(judge, after(at, 5, y_mm=y_mm))[0] is cause


def test_arm_that_runs_past_its_goal_is_off_its_way(judge: MotionJudge, at: At) -> None:
    assert verdict(judge, travel(at, 12.0, 0.1))[0] is EndCause.OFF_PATH


@pytest.mark.parametrize(("turn_rad", "cause"), [(0.008, None), (0.010, EndCause.OFF_PATH)])
def test_arm_that_turns_where_no_turn_was_approved_is_stopped(
    move: BeginMove, reading: ArmState, turn_rad: float, cause: EndCause | None
) -> None:
    judge = MotionJudge(move, reading, np.zeros(3), 0.0)
    joints_rad = reading.joints_rad + turn_rad * np.eye(6)[5]
    turned = replace(reading, joints_rad=joints_rad, base_from_tcp=base_from_flange(joints_rad), program_running=True)
    readings = (replace(turned, controller_time_s=time_s, received_at_s=time_s) for time_s in (0.008, 0.016, 0.024))
    assert verdict(judge, readings)[0] is cause


def test_motion_that_takes_far_longer_than_planned_is_ended(judge: MotionJudge, at: At) -> None:
    readings = (at(0.1 * index, x_mm=0.06 * index, speed_mm_s=0.6) for index in range(1, 1000))
    cause, time_s = verdict(judge, readings)
    assert cause is EndCause.OVERDUE
    assert time_s == pytest.approx(4 * 0.9 + 5.0, abs=0.2)


def test_arm_as_the_permit_says_may_move(move: BeginMove, reading: ArmState) -> None:
    assert refuse_arm(move, reading) is None
    assert refuse_tcp(move, np.eye(4)) is None


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"safety": SafetyState.PROTECTIVE_STOP}, RefusalCode.ARM_NOT_READY),
        ({"safety": SafetyState.OFF}, RefusalCode.ARM_NOT_READY),
        ({"tcp_speed_mm_s": 1.0}, RefusalCode.ARM_NOT_AT_REST),
        ({"tcp_turn_speed_rad_s": 0.01}, RefusalCode.ARM_NOT_AT_REST),
        ({"payload_kg": 1.1}, RefusalCode.PAYLOAD_MISMATCH),
        ({"payload_centre_mm": np.array([0.0, 0.0, 56.0])}, RefusalCode.PAYLOAD_MISMATCH),
    ],
)
def test_arm_that_differs_from_the_permit_may_not_move(
    move: BeginMove, reading: ArmState, change: dict[str, object], code: RefusalCode
) -> None:
    refusal = refuse_arm(move, replace(reading, **change))
    assert refusal is not None
    assert refusal.code is code


@pytest.mark.hazard("H04")
@pytest.mark.parametrize(("joint", "step_rad"), [(0, 2e-4), (5, 5e-4), (5, 2 * np.pi), (4, -4e-4)])
def test_joints_other_than_the_permits_are_refused(
    move: BeginMove, reading: ArmState, joint: int, step_rad: float
) -> None:
    joints = reading.joints_rad.copy()
    joints[joint] += step_rad
    refusal = refuse_arm(move, replace(reading, joints_rad=joints))
    assert refusal is not None
    assert refusal.code is RefusalCode.ARM_MOVED_SINCE_PERMIT


def test_joints_within_the_noise_of_the_encoders_are_the_permits(move: BeginMove, reading: ArmState) -> None:
    assert refuse_arm(move, replace(reading, joints_rad=reading.joints_rad + 2e-5)) is None


def test_speed_above_the_cap_is_refused(move: BeginMove, reading: ArmState) -> None:
    refusal = refuse_arm(replace(move, speed_mm_s=20.5), reading)
    assert refusal is not None
    assert (refusal.code, refusal.measured, refusal.limit) == (RefusalCode.SPEED_ABOVE_CAP, 20.5, 20.0)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"base_from_tcp": np.full((4, 4), math.nan)}, RefusalCode.MOVE_TOO_FAR),
        ({"joints_rad": np.full(6, math.nan)}, RefusalCode.ARM_MOVED_SINCE_PERMIT),
        ({"payload_kg": math.nan}, RefusalCode.PAYLOAD_MISMATCH),
        ({"payload_centre_mm": np.full(3, math.nan)}, RefusalCode.PAYLOAD_MISMATCH),
    ],
)
def test_reading_that_is_no_number_may_not_move(
    move: BeginMove, reading: ArmState, change: dict[str, object], code: RefusalCode
) -> None:
    refusal = refuse_arm(move, replace(reading, **change))
    assert refusal is not None
    assert refusal.code is code


def test_tcp_that_is_no_number_is_refused(move: BeginMove) -> None:
    refusal = refuse_tcp(move, np.full((4, 4), math.nan))
    assert refusal is not None
    assert refusal.code is RefusalCode.TCP_MISMATCH


@pytest.mark.parametrize("wrong", ["translation", "rotation"])
def test_tcp_other_than_the_calibrated_one_is_refused(move: BeginMove, wrong: str) -> None:
    tcp = np.eye(4)
    if wrong == "translation":
        tcp[2, 3] = 0.06  # mm, above 0.05
    else:
        tcp[:2, :2] = [[np.cos(4e-4), -np.sin(4e-4)], [np.sin(4e-4), np.cos(4e-4)]]
    refusal = refuse_tcp(move, tcp)
    assert refusal is not None
    assert refusal.code is RefusalCode.TCP_MISMATCH
