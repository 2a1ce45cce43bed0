"""The room's own UR5: where its flange is, nominally and truly.

Written apart from the product's kinematics, so that a shared mistake cannot cancel. Lengths in mm, angles in rad;
Denavit-Hartenberg convention: from link i - 1 to i, turn theta and shift d along z, then shift a and turn alpha
along x.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

JOINTS = 6
JOINT_LIMIT_RAD = 2.0 * pi
JOINT_SPEED_LIMIT_RAD_S = pi  # UR5 data sheet: 180 deg/s

# Stands for the length at which a turn weighs as much as a shift when a pose is approached.
_LEVER_MM = 300.0
_CONVERGED_MM = 1e-7
_ITERATIONS = 60
_STEP_LIMIT_RAD = 0.5


@dataclass(frozen=True, slots=True)
class Links:
    """Denavit-Hartenberg constants of one arm, base to flange."""

    a_mm: tuple[float, ...]
    d_mm: tuple[float, ...]
    alpha_rad: tuple[float, ...]
    theta_offset_rad: tuple[float, ...] = (0.0,) * JOINTS


NOMINAL_UR5 = Links(
    a_mm=(0.0, -425.0, -392.25, 0.0, 0.0, 0.0),
    d_mm=(89.159, 0.0, 0.0, 109.15, 94.65, 82.3),
    alpha_rad=(pi / 2, 0.0, 0.0, pi / 2, -pi / 2, 0.0),
)


def link_poses(links: Links, joints_rad: Array) -> Array:
    """Poses of all link frames in the base frame.

    Parameters
    ----------
    links : Links
        The arm.
    joints_rad : (6,)
        Joint angles.

    Returns
    -------
    (7, 4, 4)
        `base_from_link`, the base itself first, the flange last; mm.
    """
    poses = np.empty((JOINTS + 1, 4, 4))
    poses[0] = np.eye(4)
    for joint in range(JOINTS):
        poses[joint + 1] = poses[joint] @ _link(links, joint, float(joints_rad[joint]))
    return poses


def base_from_flange(links: Links, joints_rad: Array) -> Array:
    """Pose of the flange, 4x4 in mm, for joint angles (6,) in rad."""
    pose: Array = link_poses(links, joints_rad)[-1]
    return pose


def jacobian(links: Links, joints_rad: Array, point_in_flange_mm: Array | None = None) -> Array:
    """Geometric Jacobian of a point fixed to the flange, both in base coordinates.

    Parameters
    ----------
    links : Links
        The arm.
    joints_rad : (6,)
        Joint angles.
    point_in_flange_mm : (3,), optional
        The point; the flange's origin without it.

    Returns
    -------
    (6, 6)
        Rows: velocity in mm/s, then angular velocity in rad/s, per joint rad/s.
    """
    poses = link_poses(links, joints_rad)
    point = poses[-1, :3, 3]
    if point_in_flange_mm is not None:
        point = point + poses[-1, :3, :3] @ point_in_flange_mm
    axes = poses[:-1, :3, 2]
    return np.vstack([np.cross(axes, point - poses[:-1, :3, 3]).T, axes.T])


def solve_joints(links: Links, goal: Array, seed_rad: Array) -> Array | None:
    """Joint angles (6,) that bring the flange to a pose, on the branch and winding nearest to the seed.

    Damped Newton steps (Levenberg-Marquardt with the residual as damping), so that the neighbourhood of a singular
    pose is crossed slowly instead of jumped over.

    Parameters
    ----------
    links : Links
        The arm.
    goal : (4, 4)
        `base_from_flange` wanted, mm.
    seed_rad : (6,)
        Where the search starts.

    Returns
    -------
    (6,) or None
        None where no solution within the joints' range was found.
    """
    joints = np.array(seed_rad, dtype=np.float64)
    scale = np.array([1.0, 1.0, 1.0, _LEVER_MM, _LEVER_MM, _LEVER_MM])
    for _ in range(_ITERATIONS):
        residual = pose_difference(base_from_flange(links, joints), goal) * scale
        distance = float(np.linalg.norm(residual))
        if distance < _CONVERGED_MM:
            return joints if bool(np.all(np.abs(joints) <= JOINT_LIMIT_RAD)) else None
        weighted = jacobian(links, joints) * scale[:, None]
        normal = weighted.T @ weighted + min(distance, 1.0) * np.eye(JOINTS)
        step = np.linalg.solve(normal, weighted.T @ residual)
        joints = joints + step * min(1.0, _STEP_LIMIT_RAD / max(float(np.abs(step).max()), 1e-12))
    return None


def pose_difference(start: Array, goal: Array) -> Array:
    """Shift in mm and rotation vector in rad, (6,) in the common frame, that lead from one 4x4 pose to another."""
    turn = Rotation.from_matrix(goal[:3, :3] @ start[:3, :3].T).as_rotvec()
    return np.concatenate([goal[:3, 3] - start[:3, 3], turn])


def planted_links(nominal: Links, error_mm: float, seed: int) -> Links:
    """The true arm behind a nominal one: every constant a little off.

    Parameters
    ----------
    nominal : Links
        What the controller computes with.
    error_mm : float
        Root mean square distance of the true flange from the nominal one over a workspace in front of the arm.
    seed : int
        Draws which constants are off by how much.
    """
    rng = np.random.default_rng(seed)
    lengths, angles = rng.standard_normal((2, JOINTS)), rng.standard_normal((2, JOINTS)) / 1000.0
    unit = _shifted(nominal, lengths, angles)
    scale = error_mm / _rms_distance_mm(nominal, unit, rng)
    return _shifted(nominal, lengths * scale, angles * scale)


def _link(links: Links, joint: int, angle_rad: float) -> Array:
    theta, alpha = angle_rad + links.theta_offset_rad[joint], links.alpha_rad[joint]
    ct, st, ca, sa = cos(theta), sin(theta), cos(alpha), sin(alpha)
    a, d = links.a_mm[joint], links.d_mm[joint]
    return np.array(
        [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0.0, sa, ca, d], [0.0, 0.0, 0.0, 1.0]]
    )


def _shifted(links: Links, lengths_mm: Array, angles_rad: Array) -> Links:
    return Links(
        a_mm=_sum(links.a_mm, lengths_mm[0]),
        d_mm=_sum(links.d_mm, lengths_mm[1]),
        alpha_rad=_sum(links.alpha_rad, angles_rad[0]),
        theta_offset_rad=_sum(links.theta_offset_rad, angles_rad[1]),
    )


def _sum(constants: tuple[float, ...], errors: Array) -> tuple[float, ...]:
    return tuple(constant + float(error) for constant, error in zip(constants, errors, strict=True))


def _rms_distance_mm(nominal: Links, true: Links, rng: np.random.Generator) -> float:
    """Over postures with the elbow bent and the tool in front, as beside a table."""
    postures = np.array([0.0, -pi / 2, pi / 2, -pi / 2, -pi / 2, 0.0]) + rng.uniform(-0.8, 0.8, (200, JOINTS))
    shifts = [base_from_flange(true, q)[:3, 3] - base_from_flange(nominal, q)[:3, 3] for q in postures]
    return float(np.sqrt(np.mean(np.sum(np.square(shifts), axis=1))))
