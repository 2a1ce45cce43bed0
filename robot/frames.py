"""Array types, and the composition of the goal."""

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]
Transform: TypeAlias = npt.NDArray[np.float64]  # (4, 4), mm, named destination_from_source


def goal_in_base(base_from_guide: Transform, guide_from_goal: Transform) -> Transform:
    """Goal of the arm from the result of targeting.

    Parameters
    ----------
    base_from_guide : (4, 4), mm
        Pose of the TCP (the guide) that the arm held *during the exposure*, not the one it holds now.
    guide_from_goal : (4, 4), mm
        Targeting result, in the guide frame of that exposure.

    Returns
    -------
    (4, 4), mm
        base_from_goal.

    Raises
    ------
    ValueError
        If one of the two is not a finite rigid transform.
    """
    return check_rigid(base_from_guide) @ check_rigid(guide_from_goal)


def motion_between(base_from_before: Transform, base_from_after: Transform) -> Transform:
    """`before_from_after` (4, 4), mm, of two poses of the guide; ValueError if one is not a rigid transform."""
    before, after = check_rigid(base_from_before), check_rigid(base_from_after)
    motion = np.eye(4)
    motion[:3, :3] = before[:3, :3].T @ after[:3, :3]
    motion[:3, 3] = before[:3, :3].T @ (after[:3, 3] - before[:3, 3])
    return motion


def check_rigid(transform: Transform) -> Transform:
    """Return a (4, 4) transform unchanged; ValueError unless it is finite, proper and rigid."""
    matrix = np.asarray(transform, dtype=np.float64)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
        raise ValueError("a transform has 4x4 finite numbers")
    rotation = matrix[:3, :3]
    orthonormal = np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-6) and np.linalg.det(rotation) > 0
    if not orthonormal or not np.array_equal(matrix[3], [0.0, 0.0, 0.0, 1.0]):
        raise ValueError("a transform is a proper rotation and a translation")
    return matrix


def distance_between(base_from_a: Transform, base_from_b: Transform) -> tuple[float, float]:
    """Distance of two poses of one frame: of their origins in mm, of their orientations in rad."""
    offset_mm = float(np.linalg.norm(base_from_a[:3, 3] - base_from_b[:3, 3]))
    return offset_mm, rotation_angle(base_from_a[:3, :3].T @ base_from_b[:3, :3])


def rotation_angle(rotation: Array) -> float:
    """Angle of a (3, 3) rotation, rad in [0, pi]; by atan2, since arccos loses precision at small angles."""
    axial = [rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]
    return float(np.arctan2(np.linalg.norm(axial), np.trace(rotation) - 1.0))
