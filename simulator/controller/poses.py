"""Between the room's matrices (mm) and the wire's poses (m, rotation vector)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

MM_PER_M = 1000.0


def matrix_from_pose(pose: Sequence[float]) -> Array:
    """4x4 in mm from x, y, z in m and a rotation vector in rad."""
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec(pose[3:6]).as_matrix()
    matrix[:3, 3] = np.asarray(pose[:3]) * MM_PER_M
    return matrix


def pose_from_matrix(matrix: Array) -> tuple[float, ...]:
    """x, y, z in m and a rotation vector in rad from a 4x4 in mm."""
    turn = Rotation.from_matrix(matrix[:3, :3]).as_rotvec()
    return (*(float(value) for value in matrix[:3, 3] / MM_PER_M), *(float(value) for value in turn))


def inverse(matrix: Array) -> Array:
    """The 4x4 that leads back."""
    back = np.eye(4)
    back[:3, :3] = matrix[:3, :3].T
    back[:3, 3] = -matrix[:3, :3].T @ matrix[:3, 3]
    return back
