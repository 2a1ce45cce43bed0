"""Kinematics against two independent libraries, published poses, and itself."""

import numpy as np
import pinocchio
import pytest
import ur_analytic_ik
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robot.kinematics import (
    A_MM,
    ALPHA_RAD,
    D_MM,
    Singularity,
    base_from_flange,
    jacobian,
    manipulability,
    solve_joints,
)

PARKED_RAD = np.deg2rad([0.0, -90.0, 90.0, -90.0, -90.0, 0.0])
joint_vectors = st.lists(st.floats(-2 * np.pi, 2 * np.pi), min_size=6, max_size=6).map(np.array)


def pinocchio_ur5() -> pinocchio.Model:
    """The arm as a chain of revolute joints about z, each placed by the fixed part of the link before it."""
    model, placement = pinocchio.Model(), pinocchio.SE3.Identity()
    parent = 0
    for index in range(6):
        parent = model.addJoint(parent, pinocchio.JointModelRZ(), placement, f"joint_{index + 1}")
        turn = Rotation.from_euler("x", ALPHA_RAD[index]).as_matrix()
        placement = pinocchio.SE3(turn, np.array([A_MM[index], 0.0, D_MM[index]]))
    model.addFrame(pinocchio.Frame("flange", parent, placement, pinocchio.FrameType.OP_FRAME))
    return model


UR5 = pinocchio_ur5()
UR5_DATA = UR5.createData()


@pytest.mark.parametrize(
    ("joints_deg", "origin_mm", "turn_rad"),
    [
        ([0.0] * 6, [-817.25, -191.45, -5.491], None),
        ([0.0, -90.0, 90.0, -90.0, -90.0, 0.0], [-486.9, -109.15, 431.859], [2.221441, 2.221441, 0.0]),
    ],
)
def test_published_poses_are_met(joints_deg: list[float], origin_mm: list[float], turn_rad: list[float] | None) -> None:
    pose = base_from_flange(np.deg2rad(joints_deg))
    assert pose[:3, 3] == pytest.approx(origin_mm, abs=1e-3)  # mm; published to the micrometre
    if turn_rad is not None:
        assert Rotation.from_matrix(pose[:3, :3]).as_rotvec() == pytest.approx(turn_rad, abs=1e-6)


@given(joints=joint_vectors)
def test_forward_kinematics_and_jacobian_agree_with_pinocchio(joints: np.ndarray) -> None:
    flange = UR5.getFrameId("flange")
    pinocchio.framesForwardKinematics(UR5, UR5_DATA, joints)
    assert base_from_flange(joints) == pytest.approx(UR5_DATA.oMf[flange].homogeneous, abs=1e-9)  # mm: rounding
    aligned = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
    oracle = pinocchio.computeFrameJacobian(UR5, UR5_DATA, joints, flange, aligned)
    assert jacobian(joints) == pytest.approx(oracle, abs=1e-9)


@given(joints=joint_vectors)
def test_forward_kinematics_agrees_with_ur_analytic_ik(joints: np.ndarray) -> None:
    oracle = np.array(ur_analytic_ik.ur5.forward_kinematics(*joints))
    oracle[:3, 3] *= 1000.0  # it speaks metres
    assert base_from_flange(joints) == pytest.approx(oracle, abs=1e-9)


@settings(max_examples=60)
@given(joints=joint_vectors, steps=st.lists(st.floats(-0.05, 0.05), min_size=6, max_size=6))
def test_joints_found_from_a_near_seed_reach_the_goal_and_keep_their_windings(
    joints: np.ndarray, steps: list[float]
) -> None:
    if manipulability(joints).smallest_singular_value < 0.05:  # where no path is planned
        return
    goal = base_from_flange(joints + steps)
    found = solve_joints(goal, joints)
    assert found is not None
    assert base_from_flange(found) == pytest.approx(goal, abs=1e-6)  # mm
    assert np.abs(found - joints).max() < 1.0  # rad: a winding would be 6.3, another branch mostly above 1


@given(joints=joint_vectors)
@settings(max_examples=60)
def test_a_branch_of_the_closed_form_solution_is_found_again(joints: np.ndarray) -> None:
    goal = base_from_flange(joints)
    in_metres = goal.copy()
    in_metres[:3, 3] /= 1000.0
    for branch in ur_analytic_ik.ur5.inverse_kinematics(in_metres):
        seed = np.array(branch) + 0.01
        if manipulability(seed).smallest_singular_value < 0.02:
            continue
        found = solve_joints(goal, seed)
        assert found is not None
        assert found == pytest.approx(np.array(branch), abs=1e-5)  # rad; the oracle's own rounding near its cusps


def test_goal_out_of_reach_has_no_joints() -> None:
    goal = base_from_flange(PARKED_RAD)
    goal[:3, 3] *= 3.0
    assert solve_joints(goal, PARKED_RAD) is None


@given(joints=joint_vectors)
def test_determinant_is_the_product_of_the_three_factors(joints: np.ndarray) -> None:
    _, q2, q3, q4, q5, _ = joints
    shoulder_mm = A_MM[1] * np.cos(q2) + A_MM[2] * np.cos(q2 + q3) + D_MM[4] * np.sin(q2 + q3 + q4)
    expected = A_MM[1] * A_MM[2] * np.sin(q3) * np.sin(q5) * shoulder_mm
    assert abs(np.linalg.det(jacobian(joints))) == pytest.approx(abs(expected), rel=1e-9, abs=1e-3)  # of 1e8 mm^3


@pytest.mark.parametrize(
    ("joints_deg", "name"),
    [
        ([0.0, -90.0, 90.0, -90.0, 0.5, 0.0], Singularity.WRIST),
        ([0.0, -41.1, -90.0, -90.0, -90.0, 0.0], Singularity.SHOULDER),
        ([0.0, -45.0, 0.5, -90.0, -90.0, 0.0], Singularity.ELBOW),
        ([0.0, -123.0, 179.0, 0.0, -90.0, 0.0], Singularity.ELBOW),
    ],
)
def test_nearest_singularity_is_named(joints_deg: list[float], name: Singularity) -> None:
    measured = manipulability(np.deg2rad(joints_deg))
    assert measured.nearest is name
    assert measured.smallest_singular_value < 0.01


def test_wrist_singularity_approached_lowers_the_smallest_singular_value() -> None:
    values = [
        manipulability(np.deg2rad([0.0, -90.0, 90.0, -90.0, wrist, 0.0])).smallest_singular_value
        for wrist in (40.0, 20.0, 10.0, 5.0, 0.0)
    ]
    assert values == sorted(values, reverse=True)
    assert values[-1] == pytest.approx(0.0, abs=1e-12)
