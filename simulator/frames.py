"""Where the fixed things of the room are. Room frame: x along the table to the patient's head, z up, mm."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

# The patient lies prone: the back is up, and the patient's left is the room's y. Origins coincide in L3's body.
ROOM_FROM_PATIENT = np.array([[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])

# Beside the table at the patient's left hip; searched for, so that every planned path can be reached from the parked
# pose in straight lines, far from every singularity (smallest singular value 0.17 at the flange with lengths in units
# of 850 mm, limit of the path check 0.05) and with forearm and wrist clear of patient and C-arm.
ROOM_FROM_BASE = np.array(
    [[1.0, 0.0, 0.0, 90.0], [0.0, 1.0, 0.0, 710.0], [0.0, 0.0, 1.0, -240.0], [0.0, 0.0, 0.0, 1.0]]
)

# The guide upright 24 cm to the patient's left of the spine, out of every image, at its working height.
PARKED_RAD = tuple(float(angle) for angle in np.deg2rad([-86.217, -75.712, -136.772, 32.484, 86.217, 0.0]))


def inverse(pose: Array) -> Array:
    """The inverse of a rigid 4x4 transform."""
    result = np.eye(4)
    result[:3, :3] = pose[:3, :3].T
    result[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return result


def displacement(shift_mm: Array, turn_rad: Array) -> Array:
    """A rigid 4x4 transform from a shift (3,) and a rotation vector (3,)."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(turn_rad).as_matrix()
    pose[:3, 3] = shift_mm
    return pose


def direction(rng: np.random.Generator) -> Array:
    """A unit vector (3,) anywhere."""
    drawn = rng.standard_normal(3)
    unit: Array = drawn / np.linalg.norm(drawn)
    return unit
