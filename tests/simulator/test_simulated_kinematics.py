"""The room's own UR5 against published values and two libraries that share no code with it."""

import numpy as np
import pinocchio
import pytest
import ur_analytic_ik
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from simulator import kinematics
from simulator.kinematics import NOMINAL_UR5

UPRIGHT = np.radians([0.0, -90.0, 90.0, -90.0, -90.0, 0.0])
joint_angles = st.lists(st.floats(-np.pi, np.pi), min_size=6, max_size=6).map(np.array)
bent = st.lists(st.floats(-0.6, 0.6), min_size=6, max_size=6).map(lambda offsets: UPRIGHT + np.array(offsets))


def pinocchio_model():
    """The same arm, built joint by joint by another library."""
    model, parent, placement = pinocchio.Model(), 0, pinocchio.SE3.Identity()
    for joint in range(6):
        parent = model.addJoint(parent, pinocchio.JointModelRZ(), placement, f"joint_{joint}")
        lengths = np.array([NOMINAL_UR5.a_mm[joint], 0.0, NOMINAL_UR5.d_mm[joint]])
        tilt = Rotation.from_euler("x", NOMINAL_UR5.alpha_rad[joint]).as_matrix()
        placement = pinocchio.SE3(tilt, lengths)
    flange = model.addFrame(pinocchio.Frame("flange", parent, placement, pinocchio.FrameType.OP_FRAME))
    return model, flange


def test_published_poses():
    assert kinematics.base_from_flange(NOMINAL_UR5, np.zeros(6))[:3, 3] == pytest.approx([-817.25, -191.45, -5.491])
    pose = kinematics.base_from_flange(NOMINAL_UR5, UPRIGHT)
    assert pose[:3, 3] == pytest.approx([-486.9, -109.15, 431.859])
    assert Rotation.from_matrix(pose[:3, :3]).as_rotvec() == pytest.approx([2.221441, 2.221441, 0.0], abs=1e-6)


@given(joint_angles)
def test_pose_and_jacobian_agree_with_pinocchio(joints):
    model, flange = pinocchio_model()
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, joints)
    assert kinematics.base_from_flange(NOMINAL_UR5, joints) == pytest.approx(data.oMf[flange].homogeneous, abs=1e-9)
    expected = pinocchio.computeFrameJacobian(model, data, joints, flange, pinocchio.LOCAL_WORLD_ALIGNED)
    assert kinematics.jacobian(NOMINAL_UR5, joints) == pytest.approx(expected, abs=1e-9)


@given(joint_angles)
def test_pose_agrees_with_the_analytic_library(joints):
    expected = np.array(ur_analytic_ik.ur5.forward_kinematics(*joints))
    expected[:3, 3] *= 1000.0
    assert kinematics.base_from_flange(NOMINAL_UR5, joints) == pytest.approx(expected, abs=1e-9)


@given(joint_angles, st.lists(st.floats(-200.0, 200.0), min_size=3, max_size=3).map(np.array))
def test_jacobian_of_a_tool_point_is_the_derivative_of_its_place(joints, point_mm):
    step_rad = 1e-6
    analytic = kinematics.jacobian(NOMINAL_UR5, joints, point_mm)[:3]

    def place(angles):
        return (kinematics.base_from_flange(NOMINAL_UR5, angles) @ [*point_mm, 1.0])[:3]

    for joint, turned in enumerate(np.eye(6) * step_rad):
        numeric = (place(joints + turned) - place(joints - turned)) / (2 * step_rad)
        assert analytic[:, joint] == pytest.approx(numeric, abs=1e-3)  # mm/rad: rounding of 1e-10 over the step


@given(bent, st.lists(st.floats(-0.1, 0.1), min_size=6, max_size=6).map(np.array))
def test_inverse_leads_back_to_the_pose_near_the_seed(joints, offsets):
    goal = kinematics.base_from_flange(NOMINAL_UR5, joints)
    solution = kinematics.solve_joints(NOMINAL_UR5, goal, joints + offsets)
    assert kinematics.base_from_flange(NOMINAL_UR5, solution) == pytest.approx(goal, abs=1e-6)
    assert solution == pytest.approx(joints, abs=1e-6)


def test_inverse_keeps_the_winding_of_its_seed():
    wound = UPRIGHT + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 2 * np.pi - 0.1])
    goal = kinematics.base_from_flange(NOMINAL_UR5, wound)
    assert kinematics.solve_joints(NOMINAL_UR5, goal, wound - 0.05) == pytest.approx(wound)


@pytest.mark.parametrize("place_mm", [[1500.0, 0.0, 400.0], [0.0, 0.0, 3000.0], [50.0, 0.0, 300.0]])
def test_pose_out_of_reach_has_no_solution(place_mm):
    goal = kinematics.base_from_flange(NOMINAL_UR5, UPRIGHT)
    goal[:3, 3] = place_mm
    assert kinematics.solve_joints(NOMINAL_UR5, goal, UPRIGHT) is None


@pytest.mark.parametrize("seed", [0, 1, 20170])
def test_planted_errors_have_the_size_asked_for(seed):
    true = kinematics.planted_links(NOMINAL_UR5, 0.5, seed)
    postures = UPRIGHT + np.random.default_rng(5).uniform(-0.8, 0.8, (300, 6))
    shifts = [
        (kinematics.base_from_flange(true, q) - kinematics.base_from_flange(NOMINAL_UR5, q))[:3, 3] for q in postures
    ]
    assert np.sqrt(np.mean(np.sum(np.square(shifts), axis=1))) == pytest.approx(0.5, rel=0.1)
    assert np.std(shifts, axis=0).max() > 0.02  # mm: not the same everywhere, or moving the base would hide it
