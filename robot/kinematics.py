"""Kinematics of the UR5: forward, geometric Jacobian, seeded inverse, closeness to a singularity.

Nominal figures: an arm differs from them by 1 to 2 mm, so that on an arm the controller's pose is the truth and these
serve to check paths (`robot.path`).
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.spatial.transform import Rotation

from robot.frames import Array, Transform

# Denavit-Hartenberg figures that Universal Robots publishes for the UR5 (CB3); mm and rad
A_MM = np.array([0.0, -425.0, -392.25, 0.0, 0.0, 0.0])
D_MM = np.array([89.159, 0.0, 0.0, 109.15, 94.65, 82.3])
ALPHA_RAD = np.array([np.pi / 2, 0.0, 0.0, np.pi / 2, -np.pi / 2, 0.0])
REACH_MM = 850.0  # the maker's figure; also the unit of length of the scaled Jacobian

_MAX_ITERATIONS = 50
_DAMPING = 1e-4  # of the scaled normal equations: keeps steps finite at a singularity, vanishes with the error
_MAX_STEP_RAD = 0.3  # a Newton step must not leap into another branch
_CONVERGED = 1e-10  # of the scaled twist: 1e-7 mm and 1e-10 rad


class Singularity(StrEnum):
    """Which of the three factors of the determinant is nearest to zero."""

    SHOULDER = "shoulder"  # wrist above the base's axis
    ELBOW = "elbow"  # arm stretched
    WRIST = "wrist"  # axes 4 and 6 parallel


@dataclass(frozen=True, slots=True)
class Manipulability:
    """How near a singularity a configuration is.

    Attributes
    ----------
    smallest_singular_value : float
        Of the Jacobian at the flange with lengths in units of the reach, dimensionless.
    nearest : Singularity
    """

    smallest_singular_value: float
    nearest: Singularity


def link_frames(joints_rad: Array) -> Array:
    """Frames of the base and of the six links.

    Parameters
    ----------
    joints_rad : (6,)

    Returns
    -------
    (7, 4, 4), mm
        base_from_link, the base itself first, the flange last.
    """
    frames = np.empty((7, 4, 4))
    frames[0] = np.eye(4)
    for index, angle in enumerate(joints_rad):
        frames[index + 1] = frames[index] @ _link(index, float(angle))
    return frames


def base_from_flange(joints_rad: Array) -> Transform:
    """Forward kinematics: pose of the flange, (4, 4) mm, from (6,) joints in rad."""
    return np.asarray(link_frames(joints_rad)[-1])


def jacobian(joints_rad: Array) -> Array:
    """Geometric Jacobian at the flange, in the base frame.

    Parameters
    ----------
    joints_rad : (6,)

    Returns
    -------
    (6, 6)
        Rows: linear velocity (mm per rad), then angular velocity (rad per rad).
    """
    frames = link_frames(joints_rad)
    axes = frames[:6, :3, 2]
    arms_mm = frames[6, :3, 3] - frames[:6, :3, 3]
    return np.vstack([np.cross(axes, arms_mm).T, axes.T])


def manipulability(joints_rad: Array) -> Manipulability:
    """Closeness of (6,) joints, rad, to the singularities.

    Notes
    -----
    det J = a2 a3 sin q3 sin q5 (a2 cos q2 + a3 cos(q2 + q3) + d5 sin(q2 + q3 + q4)), up to its sign; the three
    factors, the last in units of its largest value, name the singularity.
    """
    smallest = float(np.linalg.svd(_scaled_jacobian(joints_rad), compute_uv=False)[-1])
    _, q2, q3, q4, q5, _ = joints_rad
    shoulder_mm = A_MM[1] * np.cos(q2) + A_MM[2] * np.cos(q2 + q3) + D_MM[4] * np.sin(q2 + q3 + q4)
    largest_mm = abs(A_MM[1]) + abs(A_MM[2]) + D_MM[4]
    factors = {
        Singularity.SHOULDER: abs(shoulder_mm) / largest_mm,
        Singularity.ELBOW: abs(np.sin(q3)),
        Singularity.WRIST: abs(np.sin(q5)),
    }
    return Manipulability(smallest, min(factors, key=lambda name: factors[name]))


def solve_joints(goal: Transform, seed_rad: Array) -> Array | None:
    """Inverse kinematics from a seed, by damped Newton steps.

    Parameters
    ----------
    goal : (4, 4), mm
        base_from_flange to be reached.
    seed_rad : (6,)
        Where to start; the answer keeps its branch and its windings where the two are close.

    Returns
    -------
    (6,) or None
        Joints in rad whose forward kinematics is the goal, or None if the steps do not get there.
    """
    joints_rad = np.array(seed_rad, dtype=np.float64)
    for _ in range(_MAX_ITERATIONS):
        twist = _scaled_twist(goal, base_from_flange(joints_rad))
        if np.linalg.norm(twist) < _CONVERGED:
            return joints_rad
        joints_rad += _newton_step(_scaled_jacobian(joints_rad), twist)
    return None


def _newton_step(scaled: Array, twist: Array) -> Array:
    """Levenberg step with a damping that vanishes with the error, so that convergence stays quadratic."""
    damping = _DAMPING * min(1.0, float(twist @ twist))
    step = scaled.T @ np.linalg.solve(scaled @ scaled.T + damping * np.eye(6), twist)
    return np.asarray(step * (_MAX_STEP_RAD / max(float(np.abs(step).max()), _MAX_STEP_RAD)))


def _scaled_twist(goal: Transform, pose: Transform) -> Array:
    """Twist in the base frame that carries a pose to the goal, lengths in units of the reach."""
    offset = (goal[:3, 3] - pose[:3, 3]) / REACH_MM
    return np.concatenate([offset, Rotation.from_matrix(goal[:3, :3] @ pose[:3, :3].T).as_rotvec()])


def _scaled_jacobian(joints_rad: Array) -> Array:
    """Jacobian with lengths in units of the reach, so that its rows can be compared."""
    scaled = jacobian(joints_rad)
    scaled[:3] /= REACH_MM
    return scaled


def _link(index: int, angle_rad: float) -> Transform:
    """Denavit-Hartenberg transform of one link (standard convention), (4, 4) mm."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    ca, sa = np.cos(ALPHA_RAD[index]), np.sin(ALPHA_RAD[index])
    a, d = A_MM[index], D_MM[index]
    return np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0.0, sa, ca, d], [0.0, 0.0, 0.0, 1.0]])
