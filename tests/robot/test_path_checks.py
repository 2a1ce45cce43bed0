"""The checks of a path one by one: at their limits, and what they say of the place."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path as Paths

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robot.frames import distance_between
from robot.kinematics import base_from_flange
from robot.line import Pace, line_between, sample_line
from robot.path import Path, Way, plan_path
from robot.path_checks import (
    refuse_extent,
    refuse_margins,
    refuse_model,
    refuse_nearness,
    refuse_singular,
    refuse_steps,
)
from robot.path_limits import PathLimits
from robot.refusal import Refusal, RefusalCode
from robot.room_shapes import read_room
from robot.shapes import Box, Occupant
from robot.sweep import Sweep, sweep
from robot.tool import read_tool

LIMITS = PathLimits()
DEVICES = Paths(__file__).parents[1] / "devices"
TOOL = read_tool((DEVICES / "tcp.toml").read_bytes())
ROOM = read_room((DEVICES / "room.toml").read_bytes())
PARKED_RAD = np.deg2rad([0.0, -90.0, 90.0, -90.0, -90.0, 0.0])
PARKED = base_from_flange(PARKED_RAD) @ TOOL.flange_from_guide


def displaced(offset_mm: float, turn_deg: float = 0.0) -> np.ndarray:
    """Along x and about z."""
    pose = np.eye(4)
    pose[0, 3] = offset_mm
    pose[:3, :3] = Rotation.from_euler("z", turn_deg, degrees=True).as_matrix()
    return pose


TURN = displaced(0.0, 3.0)
TURNED_RAD = distance_between(np.eye(4), TURN)[1]
LINE = line_between(np.eye(4), displaced(10.0))
STEPS_RAD = np.zeros((5, 6))
STEPS_RAD[2:, 3] = 0.125  # from the second sample to the third


@pytest.mark.parametrize(
    ("check", "limit"),
    [
        (lambda limits: refuse_model(line_between(displaced(3.0), np.eye(4)), np.eye(4), limits), "model_offset_mm=3"),
        (lambda limits: refuse_model(line_between(TURN, np.eye(4)), np.eye(4), limits), "model_turn_rad"),
        (lambda limits: refuse_extent(LINE, limits), "length_mm=10"),
        (lambda limits: refuse_extent(line_between(np.eye(4), TURN), limits), "angle_rad"),
        (lambda limits: refuse_margins(np.array([0.5, 0.25]), STEPS_RAD, limits), "joint_margin_rad=0.25"),
        (lambda limits: refuse_singular(np.array([0.5, 0.25]), STEPS_RAD, limits), "smallest_singular_value=0.25"),
        (lambda limits: refuse_steps(LINE, Pace(20.0, 50.0, 1.0), STEPS_RAD, limits), "joint_jump_rad=0.125"),
        (lambda limits: refuse_steps(LINE, Pace(20.0, 50.0, 1.0), STEPS_RAD, limits), "joint_speed_rad_s=1"),
    ],
)
def test_a_path_may_come_up_to_its_limit_and_no_further(
    check: Callable[[PathLimits], Refusal | None], limit: str
) -> None:
    name, _, at = limit.partition("=")
    value = float(at) if at else TURNED_RAD
    beyond = 1e-9 if name in ("joint_margin_rad", "smallest_singular_value") else -1e-9
    roomy = replace(LIMITS, joint_speed_rad_s=9.0)
    assert check(replace(roomy, **{name: value})) is None
    assert check(replace(roomy, **{name: value + beyond})) is not None


def test_a_leap_and_a_haste_of_the_joints_are_told_with_their_place() -> None:
    pace = Pace(20.0, 50.0, 1.0)
    leap = refuse_steps(LINE, pace, STEPS_RAD, replace(LIMITS, joint_jump_rad=0.1))
    assert leap is not None
    assert (leap.code, leap.measured, leap.limit) == (RefusalCode.JOINT_JUMP, 0.125, 0.1)
    assert "at sample 2 of 4" in leap.message
    haste = refuse_steps(LINE, pace, STEPS_RAD, LIMITS)  # 0.125 rad in 2.5 mm at 20 mm/s
    assert haste is not None
    assert (haste.code, haste.measured) == (RefusalCode.JOINT_SPEED, pytest.approx(1.0))
    assert "at sample 2 of 4" in haste.message


@pytest.mark.hazard("H11")
def test_a_haste_of_the_joints_is_none_the_less_one_on_a_short_way() -> None:
    short = line_between(np.eye(4), displaced(1.0))  # in steps of 0.25 mm
    refusal = refuse_steps(short, Pace(20.0, 50.0, 0.4), STEPS_RAD, LIMITS)
    assert refusal is not None
    assert (refusal.code, refusal.measured) == (RefusalCode.JOINT_SPEED, pytest.approx(0.125 * 20.0 / 0.25))


def test_a_path_to_where_the_arm_is_has_no_speed() -> None:
    nowhere = line_between(np.eye(4), np.eye(4))
    assert len(sample_line(nowhere)) == 3
    assert (
        refuse_steps(nowhere, Pace(20.0, 50.0, 0.0), np.zeros((3, 6)), replace(LIMITS, joint_speed_rad_s=0.0)) is None
    )


def test_margins_are_told_with_their_sample() -> None:
    at_limit = refuse_margins(np.array([0.5, 0.01]), np.eye(6)[:2], LIMITS)
    singular = refuse_singular(np.array([0.5, 0.01]), np.tile(PARKED_RAD, (2, 1)), LIMITS)
    assert at_limit is not None
    assert singular is not None
    assert "joint 2" in at_limit.message
    assert "at sample 1 of 1" in at_limit.message
    assert "at sample 1 of 1" in singular.message


def swept_past(clearances_mm: list[list[float]]) -> Sweep:
    """Four segments, one shape; two parts."""
    clearances = np.array(clearances_mm)[:, :, None]
    return Sweep(("table",), ("guide", "wrist"), clearances, clearances[0])


def test_nearness_is_judged_by_what_each_part_needs_and_told_with_its_place() -> None:
    swept = swept_past([[50.0, 50.0], [50.0, 9.0], [12.0, 50.0], [50.0, 50.0]])
    needed_mm = np.array([[15.0], [5.0]])  # the wrist comes nearer and may
    refusal = refuse_nearness(LINE, swept, needed_mm)
    assert refusal is not None
    assert (refusal.measured, refusal.limit) == (12.0, 15.0)
    assert "guide comes too near the room's table between samples 2 and 3 of 4, 5 to 8 mm" in refusal.message
    assert refuse_nearness(LINE, swept, np.array([[12.0], [5.0]])) is None


@pytest.mark.parametrize("joints_rad", [np.zeros(5), np.zeros((1, 6)), np.array([0.0, 0.0, np.nan, 0.0, 0.0, 0.0])])
def test_joints_that_no_arm_has_are_the_callers_mistake(joints_rad: np.ndarray) -> None:
    with pytest.raises(ValueError, match="six finite"):
        plan_path(Way(joints_rad, PARKED, PARKED), TOOL, ROOM, LIMITS)


@pytest.mark.hazard("H11")
@pytest.mark.parametrize(("wrist_deg", "refused"), [(-8.0, True), (-11.0, False)])
def test_nine_degrees_from_the_wrists_singularity_no_path_begins(wrist_deg: float, refused: bool) -> None:
    joints_rad = PARKED_RAD.copy()
    joints_rad[4] = np.deg2rad(wrist_deg)
    pose = base_from_flange(joints_rad) @ TOOL.flange_from_guide
    answer = plan_path(Way(joints_rad, pose, pose), TOOL, replace(ROOM, clearance_mm=-1e4), LIMITS)
    assert (isinstance(answer, Refusal) and answer.code is RefusalCode.NEAR_SINGULARITY) is refused


@pytest.mark.hazard("H10")
@pytest.mark.parametrize(("turn_deg", "refused"), [(0.9, False), (1.1, True)])
def test_a_pose_a_degree_from_what_the_joints_say_is_no_start(turn_deg: float, refused: bool) -> None:
    reported = PARKED @ displaced(0.0, turn_deg)
    assert isinstance(plan_path(Way(PARKED_RAD, reported, reported), TOOL, ROOM, LIMITS), Refusal) is refused


@pytest.mark.hazard("H12")
def test_a_way_that_is_not_said_to_lead_away_keeps_its_distance_from_the_start() -> None:
    back = Box("back", Occupant.PATIENT, PARKED, np.full(3, 10.0))
    way = Way(PARKED_RAD, PARKED, PARKED)
    answer = plan_path(way, TOOL, replace(ROOM, shapes=(back,)), LIMITS)
    assert isinstance(answer, Refusal)
    assert isinstance(plan_path(replace(way, leaving=True), TOOL, replace(ROOM, shapes=(back,)), LIMITS), Path)


def wall(at_mm: float) -> Box:
    """A face across base x that the arm does not reach, and that is much wider than the arm."""
    place = np.eye(4)
    place[0, 3] = at_mm + 10.0
    return Box("wall", Occupant.OTHER, place, np.array([10.0, 5e3, 5e3]))


def clearances(poses: np.ndarray, joints_rad: np.ndarray) -> Sweep:
    return sweep(poses, joints_rad, TOOL.flange_from_guide, TOOL.envelope, replace(ROOM, shapes=(wall(2000.0),)))


@pytest.mark.hazard("H12")
def test_the_links_are_carried_along_with_the_difference_of_arm_and_model() -> None:
    joints = np.tile(PARKED_RAD, (2, 1))
    nominal = clearances(np.tile(PARKED, (2, 1, 1)), joints)
    real = clearances(np.tile(displaced(7.0) @ PARKED, (2, 1, 1)), joints)
    assert nominal.clearances_mm - real.clearances_mm == pytest.approx(7.0, abs=1e-6)


def test_a_sweep_leaves_no_sample_out() -> None:
    with pytest.raises(ValueError, match="shorter"):
        clearances(np.tile(PARKED, (3, 1, 1)), np.tile(PARKED_RAD, (2, 1)))


@pytest.mark.hazard("H12")
def test_between_two_samples_half_a_step_is_lost_of_a_clearance() -> None:
    """And where the step changes, half of the change: four times what a smooth way leaves its chord by."""
    offsets_mm = np.array([0.0, 4.0, 8.0, 14.0])
    poses = np.stack([displaced(float(offset)) @ PARKED for offset in offsets_mm])
    swept = clearances(poses, np.tile(PARKED_RAD, (4, 1)))
    still = clearances(np.tile(PARKED, (2, 1, 1)), np.tile(PARKED_RAD, (2, 1)))
    lost_mm = still.clearances_mm[0] - offsets_mm[1:, None, None] - swept.clearances_mm
    assert lost_mm == pytest.approx(np.broadcast_to(np.array([2.0, 3.0, 4.0])[:, None, None], lost_mm.shape), abs=1e-6)
