"""Poses that a person finds by eye, off by some millimetres and degrees."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator.frames import direction
from simulator.truth import HandTruth

Array = NDArray[np.float64]

GUIDE_FROM_SOURCE_MM = 765.0  # the big ring a hand's width above the back, 23 cm below the intensifier
_ROBOT_TO_PATIENT = np.array([0.0, -1.0, 0.0])  # the guide's x points away from the arm, room frame


def guide_in_beam(source_in_room: Array, target_in_room: Array) -> Array:
    """Pose of a guide (4x4, mm, room frame) exactly in the beam from source to target."""
    ray = target_in_room - source_in_room
    ray = ray / np.linalg.norm(ray)
    x = _ROBOT_TO_PATIENT - ray * (_ROBOT_TO_PATIENT @ ray)
    x = x / np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(ray, x), ray])
    pose[:3, 3] = source_in_room + GUIDE_FROM_SOURCE_MM * ray
    return pose


def led_by_hand(pose: Array, hand: HandTruth, rng: np.random.Generator) -> Array:
    """The pose that somebody reaches who aims at a pose (4x4, mm)."""
    lean = np.deg2rad(hand.approach_error_deg) * rng.standard_normal() * direction(rng)
    reached = pose.copy()
    reached[:3, :3] = Rotation.from_rotvec(lean).as_matrix() @ pose[:3, :3]
    reached[:3, 3] += hand.approach_error_mm * rng.standard_normal(3)
    return reached
