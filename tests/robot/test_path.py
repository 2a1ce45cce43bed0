"""Straight-line paths: what they keep, and what they are refused for."""

import re
from dataclasses import replace
from pathlib import Path as Paths

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robot.frames import goal_in_base
from robot.kinematics import base_from_flange
from robot.line import line_between, pace_of, sample_line
from robot.path import Path, Way, plan_path
from robot.path_limits import PathLimits
from robot.refusal import Refusal, RefusalCode
from robot.room_shapes import read_room
from robot.tool import read_tool

LIMITS = PathLimits()
PARKED_RAD = np.deg2rad([0.0, -90.0, 90.0, -90.0, -90.0, 0.0])
TOOL = read_tool((Paths(__file__).parents[1] / "devices" / "tcp.toml").read_bytes())
FLANGE_FROM_GUIDE = TOOL.flange_from_guide
FAR_ROOM = read_room((Paths(__file__).parents[1] / "devices" / "room.toml").read_bytes())
PARKED = base_from_flange(PARKED_RAD) @ FLANGE_FROM_GUIDE


def moved(pose: np.ndarray, offset_mm: list[float], turn_deg: list[float] | None = None) -> np.ndarray:
    goal = pose.copy()
    goal[:3, 3] += offset_mm
    goal[:3, :3] = goal[:3, :3] @ Rotation.from_rotvec(turn_deg or [0.0] * 3, degrees=True).as_matrix()
    return goal


def planned(goal: np.ndarray, limits: PathLimits = LIMITS, joints_rad: np.ndarray = PARKED_RAD) -> Path | Refusal:
    return plan_path(Way(joints_rad, base_from_flange(joints_rad) @ FLANGE_FROM_GUIDE, goal), TOOL, FAR_ROOM, limits)


def refused(outcome: Path | Refusal, code: RefusalCode) -> Refusal:
    assert isinstance(outcome, Refusal), outcome
    assert outcome.code is code, outcome
    return outcome


@settings(max_examples=25)
@given(
    offset_mm=st.lists(st.floats(-60.0, 60.0), min_size=3, max_size=3),
    turn_deg=st.lists(st.floats(-12.0, 12.0), min_size=3, max_size=3),
)
def test_path_near_the_parked_pose_follows_the_line_without_a_leap(
    offset_mm: list[float], turn_deg: list[float]
) -> None:
    goal = moved(PARKED, offset_mm, turn_deg)
    path = planned(goal)
    assert isinstance(path, Path)
    poses = [base_from_flange(joints) @ FLANGE_FROM_GUIDE for joints in path.joints_rad]
    assert poses[0] == pytest.approx(PARKED, abs=1e-5)  # mm: what the inverse kinematics converges to
    assert poses[-1] == pytest.approx(goal, abs=1e-5)
    direction = goal[:3, 3] - PARKED[:3, 3]
    offsets = [np.linalg.norm(np.cross(pose[:3, 3] - PARKED[:3, 3], direction)) for pose in poses]
    assert max(offsets) <= 1e-5 * max(float(np.linalg.norm(direction)), 1.0)
    assert np.abs(np.diff(path.joints_rad, axis=0)).max() < LIMITS.joint_jump_rad
    assert path.length_mm / path.duration_s <= 20.0 if path.duration_s else path.length_mm == 0.0  # H12
    assert path.angle_rad <= np.deg2rad(5.0) * path.duration_s + 1e-12  # H12


def test_windings_of_the_start_are_kept() -> None:
    wound = PARKED_RAD + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 2 * np.pi - 0.5])
    path = planned(moved(base_from_flange(wound) @ FLANGE_FROM_GUIDE, [10.0, 0.0, 0.0]), joints_rad=wound)
    assert isinstance(path, Path)
    assert path.joints_rad[-1] == pytest.approx(wound, abs=0.1)


@pytest.mark.hazard("H11")
def test_goal_out_of_reach_is_refused_with_the_sample_where_the_arm_ends() -> None:
    limits = replace(LIMITS, length_mm=600.0)
    refusal = refused(planned(moved(PARKED, [-500.0, 0.0, 0.0]), limits), RefusalCode.GOAL_UNREACHABLE)
    sample = int(re.search(r"sample (\d+) of 250", refusal.message)[1])  # 500 mm in steps of 2 mm
    flange = moved(PARKED, [-2.0 * sample, 0.0, 0.0]) @ np.linalg.inv(FLANGE_FROM_GUIDE)
    shoulder_mm = np.array([0.0, 0.0, 89.159])  # of a UR5, in the base
    assert refusal.measured == pytest.approx(np.linalg.norm(flange[:3, 3] - shoulder_mm), abs=0.01)
    assert refusal.measured == pytest.approx(refusal.limit, abs=40.0)  # mm: the reach depends on the wrist


@pytest.mark.hazard("H11")
def test_line_through_the_wrist_singularity_is_refused_by_its_name() -> None:
    before, after = PARKED_RAD.copy(), PARKED_RAD.copy()
    before[4], after[4] = np.deg2rad([-20.0, 20.0])
    goal = base_from_flange(after) @ FLANGE_FROM_GUIDE
    limits = replace(LIMITS, length_mm=600.0, angle_rad=2.0)
    refusal = refused(planned(goal, limits, joints_rad=before), RefusalCode.NEAR_SINGULARITY)
    assert "wrist" in refusal.message
    assert refusal.measured is not None
    assert refusal.measured < LIMITS.smallest_singular_value


@pytest.mark.hazard("H11")
def test_joint_that_ends_too_near_its_limit_is_refused_and_named() -> None:
    wound = PARKED_RAD.copy()
    wound[5] = 2 * np.pi - np.deg2rad(10.0)
    start = base_from_flange(wound) @ FLANGE_FROM_GUIDE
    outcomes = [planned(moved(start, [0.0] * 3, [0.0, 0.0, sign * 8.0]), joints_rad=wound) for sign in (1, -1)]
    refusals = [outcome for outcome in outcomes if isinstance(outcome, Refusal)]
    assert len(refusals) == 1  # turning back is allowed
    assert refusals[0].code is RefusalCode.JOINT_LIMIT
    assert "joint 6" in refusals[0].message
    assert refusals[0].measured == pytest.approx(
        np.deg2rad(2.0), abs=5e-3
    )  # rad; the other joints take a share of the turn


def test_joint_that_would_turn_too_fast_is_refused() -> None:
    limits = replace(LIMITS, joint_speed_rad_s=0.02)
    refusal = refused(planned(moved(PARKED, [0.0, 50.0, 0.0]), limits), RefusalCode.JOINT_SPEED)
    assert refusal.measured is not None
    assert refusal.measured > 0.02


@pytest.mark.parametrize("goal", [moved(PARKED, [0.0, 150.1, 0.0]), moved(PARKED, [0.0] * 3, [0.0, 0.0, 35.1])])
def test_path_too_long_or_turning_too_far_is_refused(goal: np.ndarray) -> None:
    refused(planned(goal), RefusalCode.PATH_TOO_LONG)


def test_path_is_never_faster_nor_more_abrupt_than_the_caps() -> None:
    hasty = replace(LIMITS, speed_mm_s=200.0, turn_speed_rad_s=1.0, acceleration_mm_s2=500.0)
    path = planned(moved(PARKED, [0.0, 50.0, 0.0]), hasty)
    assert isinstance(path, Path)
    assert (path.speed_mm_s, path.acceleration_mm_s2) == (20.0, 50.0)


def test_controller_pose_that_its_joints_do_not_explain_is_refused() -> None:
    refusal = refused(
        plan_path(Way(PARKED_RAD, moved(PARKED, [0.0, 0.0, 6.0]), PARKED), TOOL, FAR_ROOM, LIMITS),
        RefusalCode.MODEL_MISMATCH,
    )
    assert refusal.measured == pytest.approx(6.0)


def test_calibrated_arm_two_millimetres_off_the_nominal_one_is_planned_from_its_own_pose() -> None:
    reported = moved(PARKED, [1.0, -1.5, 0.8])
    path = plan_path(Way(PARKED_RAD, reported, moved(reported, [0.0, 40.0, 0.0])), TOOL, FAR_ROOM, LIMITS)
    assert isinstance(path, Path)
    assert path.joints_rad[0] == pytest.approx(PARKED_RAD, abs=1e-8)
    assert path.length_mm == pytest.approx(40.0)


@pytest.mark.parametrize("broken", [np.nan, np.inf])
def test_goal_that_is_no_transform_is_the_callers_mistake(broken: float) -> None:
    goal = PARKED.copy()
    goal[0, 3] = broken
    with pytest.raises(ValueError, match="finite"):
        planned(goal)


def test_mirrored_goal_is_the_callers_mistake() -> None:
    goal = PARKED.copy()
    goal[:3, 0] *= -1.0
    with pytest.raises(ValueError, match="proper"):
        planned(goal)


def test_duration_of_a_long_line_is_a_trapezoids_and_of_a_short_one_a_triangles() -> None:
    long = pace_of(line_between(PARKED, moved(PARKED, [100.0, 0.0, 0.0])), 20.0, 50.0, 250.0)
    assert long.duration_s == pytest.approx(100.0 / 20.0 + 20.0 / 50.0)
    short = pace_of(line_between(PARKED, moved(PARKED, [2.0, 0.0, 0.0])), 20.0, 50.0, 250.0)
    assert short.duration_s == pytest.approx(2.0 * np.sqrt(2.0 / 50.0))


def test_samples_are_never_further_apart_than_promised() -> None:
    poses = sample_line(line_between(PARKED, moved(PARKED, [30.0, 10.0, 0.0], [0.0, 20.0, 5.0])))
    steps_mm = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1)
    turns = Rotation.from_matrix(poses[:-1, :3, :3]).inv() * Rotation.from_matrix(poses[1:, :3, :3])
    assert steps_mm.max() <= 2.0 + 1e-9
    assert turns.magnitude().max() <= np.deg2rad(0.5) + 1e-9


def test_goal_is_composed_with_the_pose_held_during_the_exposure() -> None:
    guide_from_goal = moved(np.eye(4), [3.0, 0.0, 0.0])
    at_exposure = moved(np.eye(4), [100.0, 0.0, 0.0], [0.0, 0.0, 90.0])
    assert goal_in_base(at_exposure, guide_from_goal)[:3, 3] == pytest.approx([100.0, 3.0, 0.0])
