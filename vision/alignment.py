"""Rays, the goal (2) to (7), and how far an axis is from a target: what targeting, bounds and evaluation share."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision.devices import Guide
from vision.projection import Intrinsics, View
from vision.refusal import Refusal, RefusalCode

Array = NDArray[np.float64]

# A depth in metres instead of millimetres falls outside, either way round (H09).
_LEAST_DEPTH_MM = 1.0
_GREATEST_DEPTH_MM = 500.0


def ray_in_source(intrinsics: Intrinsics, pixel_corrected: Array) -> Array:
    """Unit directions (..., 3) in the source frame, from the source through corrected pixels (..., 2); eq. (2)."""
    x = (pixel_corrected[..., 0] - intrinsics.u0_px) / intrinsics.alpha_x_px
    y = (pixel_corrected[..., 1] - intrinsics.v0_px) / intrinsics.alpha_y_px
    direction = np.stack((x, y, np.ones_like(x)), axis=-1)
    return np.asarray(direction / np.linalg.norm(direction, axis=-1, keepdims=True))


def goal(view: View, pixel_corrected: Array) -> tuple[Array, Array]:
    """Where the guide must go so that its axis is a pixel's ray.

    Parameters
    ----------
    view : View
        Intrinsics and `source_from_guide`.
    pixel_corrected : Array
        (..., 2), corrected pixels of targets.

    Returns
    -------
    guide_from_goal : Array
        (..., 4, 4), mm.
    rotation_vector : Array
        (..., 3), guide frame, rad: the minimal rotation.

    Notes
    -----
    Eq. (3) keeps the small ring's distance from the source, (4) goes to the guide frame, (5) and (6) are the minimal
    rotation of z onto the ray, with atan2 for the paper's arccos, which loses small angles; (7) joins them.
    """
    rotation, translation = view.source_from_guide[:3, :3], view.source_from_guide[:3, 3]
    ray = ray_in_source(view.intrinsics, pixel_corrected)
    rotation_vector = angle_between(np.array([0.0, 0.0, 1.0]), ray @ rotation)
    guide_from_goal = np.zeros((*ray.shape[:-1], 4, 4))
    turned = Rotation.from_rotvec(rotation_vector.reshape(-1, 3)).as_matrix()
    guide_from_goal[..., :3, :3] = turned.reshape(*ray.shape, 3)
    guide_from_goal[..., :3, 3] = (np.linalg.norm(translation) * ray - translation) @ rotation
    guide_from_goal[..., 3, 3] = 1.0
    return guide_from_goal, rotation_vector


def angle_between(start: Array, end: Array) -> Array:
    """Rotation vectors (..., 3), rad, of the minimal rotations that carry unit `start` onto unit `end`, (..., 3)."""
    normal = np.cross(start, end)
    sine = np.linalg.norm(normal, axis=-1, keepdims=True)
    angle = np.arctan2(sine, (start * end).sum(axis=-1, keepdims=True))
    return np.asarray(normal * (angle / np.where(sine == 0.0, 1.0, sine)))


def target_in_source(view: View, pixel_corrected: Array, guide: Guide, depth_mm: float) -> Array:
    """Point (3,) on the pixel's ray `depth_mm` below (towards the source of) the big ring, source frame, mm."""
    distance_mm = float(np.linalg.norm(view.source_from_guide[:3, 3])) - guide.separation_mm - depth_mm
    return ray_in_source(view.intrinsics, pixel_corrected) * distance_mm


def check_depth(view: View, guide: Guide, depth_mm: float) -> Refusal | None:
    """A refusal unless the target's depth is plausible and in front of the source."""
    room_mm = float(np.linalg.norm(view.source_from_guide[:3, 3])) - guide.separation_mm
    limit_mm = min(_GREATEST_DEPTH_MM, room_mm)
    if not math.isfinite(depth_mm):
        return Refusal(RefusalCode.TARGET_NOT_FINITE, "the target's depth is no number")
    if depth_mm < _LEAST_DEPTH_MM:
        message = "the target's depth below the big ring is implausibly small, mm"
        return Refusal(RefusalCode.TARGET_NOT_REACHABLE, message, depth_mm, _LEAST_DEPTH_MM)
    if depth_mm >= limit_mm:
        message = "the target's depth below the big ring is implausible or reaches the X-ray source, mm"
        return Refusal(RefusalCode.TARGET_NOT_REACHABLE, message, depth_mm, limit_mm)
    return None


def angle_vector(axis: Array, ray: Array) -> Array:
    """Angle errors (12) as rotation vectors (..., 3), rad, from the unit `axis` to the unit `ray`."""
    return angle_between(axis, ray)


def position_vector(on_axis: Array, axis: Array, target: Array) -> Array:
    """Position errors (13) as vectors (..., 3), mm, from the axis to the target, perpendicular to the unit `axis`."""
    offset = target - on_axis
    return np.asarray(offset - axis * (offset * axis).sum(axis=-1, keepdims=True))
