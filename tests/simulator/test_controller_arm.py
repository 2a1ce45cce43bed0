"""The arm by itself, cycle by cycle: stops in every phase of a motion, and where it truly stands."""

import numpy as np
import pytest

from simulator.controller import ArmTruth, ControllerSettings
from simulator.controller.arm import Arm, shifted

CYCLE_S = 0.008
DOWN = np.array([0.0, 0.0, -20.0])


@pytest.fixture
def arm():
    return Arm(ControllerSettings("127.0.0.9"))


def run(arm, cycles):
    """Joint speeds (cycles + 1, 6) in rad/s, the present ones first."""
    speeds = [arm.speeds_rad_s]
    for _ in range(cycles):
        assert arm.advance(CYCLE_S, 1.0)
        speeds.append(arm.speeds_rad_s)
    return np.array(speeds)


@pytest.mark.parametrize("stop", ["brake_joints", "brake_linear", "hold"])
def test_stop_before_the_first_cycle_of_a_motion_leaves_the_arm_where_it_is(arm, stop):
    before = arm.joints_rad
    arm.move_linear(shifted(arm.base_from_tcp, DOWN), 20.0, 100.0)
    getattr(arm, stop)(*([] if stop == "hold" else [2.0]))
    run(arm, 200)
    assert arm.joints_rad == pytest.approx(before, abs=1e-12)
    assert arm.at_rest


def test_joint_stop_slows_all_joints_down_in_step(arm):
    arm.move_linear(shifted(arm.base_from_tcp, DOWN), 20.0, 100.0)
    run(arm, 50)
    arm.brake_joints(0.5)
    speeds = run(arm, 100)
    assert arm.at_rest
    assert np.abs(np.diff(speeds, axis=0)).max() / CYCLE_S <= 0.5 + 1e-6  # rad/s2
    middle = speeds[2] / np.abs(speeds[2]).max()
    assert speeds[4] / np.abs(speeds[4]).max() == pytest.approx(middle, abs=1e-6)


def test_linear_stop_of_a_joint_motion_brakes_the_tool_as_asked(arm):
    arm.move_joints(arm.joints_rad + np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 0.2, 1.0)
    run(arm, 100)
    tool_speed = np.linalg.norm(arm.tcp_velocity[:3])
    arm.brake_linear(200.0)
    cycles = int(tool_speed / 200.0 / CYCLE_S)
    run(arm, cycles - 2)
    assert not arm.at_rest
    run(arm, 5)
    assert arm.at_rest


def test_true_place_moves_without_a_jump_from_one_arrival_to_the_next(arm):
    arm.move_linear(shifted(arm.base_from_tcp, DOWN), 20.0, 100.0)
    places = [arm.base_from_flange_true[:3, 3]]
    for _ in range(200):
        arm.advance(CYCLE_S, 1.0)
        places.append(arm.base_from_flange_true[:3, 3])
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() < 20.0 * CYCLE_S * 1.05  # mm: 5 % for planted errors


def test_tiny_motion_keeps_most_of_its_offset():
    settings = ControllerSettings("127.0.0.9", truth=ArmTruth(kinematic_error_mm=0.0, repeatability_mm=1.0))
    arm = Arm(settings)

    def offset_mm():
        return arm.base_from_flange_true[:3, 3] - arm.base_from_flange[:3, 3]

    before = offset_mm()
    arm.move_linear(shifted(arm.base_from_tcp, np.array([0.0, 0.0, 0.02])), 20.0, 100.0)
    run(arm, 50)
    assert np.linalg.norm(offset_mm() - before) < 0.05  # mm: a hundredth of the settling way


def test_same_seed_plants_the_same_arm():
    one, other = (Arm(ControllerSettings("127.0.0.9")) for _ in range(2))
    assert np.array_equal(one.base_from_flange_true, other.base_from_flange_true)
    third = Arm(ControllerSettings("127.0.0.9", truth=ArmTruth(seed=1)))
    assert not np.array_equal(one.base_from_flange_true, third.base_from_flange_true)
