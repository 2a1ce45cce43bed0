"""A long way in pieces that are short enough to be approved one by one."""

from collections.abc import Iterator
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

Array = NDArray[np.float64]

# A little less than the service allows for one motion, since the arm does not stop where it was told to the micrometre.
_LONGEST_MM = 145.0
_LARGEST_DEG = 34.0


def legs(base_from_start: Array, goal: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Poses on the straight way from a pose (4x4, mm) to a goal, each in the form in which a goal is given."""
    origin_mm, target_mm = base_from_start[:3, 3], np.array(goal["translation_mm"])
    turns = Rotation.from_matrix(base_from_start[:3, :3]), Rotation.from_rotvec(goal["rotation_vector_deg"], True)
    angle_deg = float(np.rad2deg((turns[0].inv() * turns[1]).magnitude()))
    count = max(1, ceil(float(np.linalg.norm(target_mm - origin_mm)) / _LONGEST_MM), ceil(angle_deg / _LARGEST_DEG))
    turn_at = Slerp([0.0, 1.0], Rotation.concatenate(turns))
    for share in np.arange(1, count + 1) / count:
        yield {
            "translation_mm": (origin_mm + share * (target_mm - origin_mm)).tolist(),
            "rotation_vector_deg": turn_at(share).as_rotvec(degrees=True).tolist(),
        }
