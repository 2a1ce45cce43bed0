"""Poses from the numbers a person or a script gives, and the controller's TCP against a calibration."""

import numpy as np
from scipy.spatial.transform import Rotation

from robot.arm import ArmState
from robot.frames import Array, Transform, distance_between
from robot.kinematics import base_from_flange
from robot.tool import Tool


def pose_of(translation_mm: Array, rotation_vector_rad: Array) -> Transform:
    """(4, 4) transform in mm from a translation (3,) and a rotation vector (3,); ValueError unless finite."""
    transform = np.eye(4)
    transform[:3, :3] = Rotation.from_rotvec(np.asarray(rotation_vector_rad, dtype=np.float64)).as_matrix()
    transform[:3, 3] = translation_mm
    if not np.isfinite(transform).all():
        raise ValueError("a pose has finite numbers")
    return transform


def retreat(distance_mm: float) -> Transform:
    """guide_from_goal of a retreat: along the guide's own axis, against the direction of insertion, which is -z."""
    return pose_of(np.array([0.0, 0.0, distance_mm]), np.zeros(3))


def tcp_difference(reading: ArmState, tool: Tool) -> tuple[float, float]:
    """How far the controller's TCP is from where its joints and the calibration put the guide, mm and rad (H10).

    By the nominal kinematics: a controller that uses a calibration of its own differs by 1 to 2 mm. The TCP itself is
    read back by the guard before each motion.
    """
    return distance_between(base_from_flange(reading.joints_rad) @ tool.flange_from_guide, reading.base_from_tcp)
