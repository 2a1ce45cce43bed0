"""The whole aim at once: what is left between the needle's axis and the true target when every step errs a little."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision.alignment import angle_vector, goal, position_vector, ray_in_source
from vision.devices import Guide
from vision.projection import View

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class AimErrors:
    """What is wrong beside the registration.

    Attributes
    ----------
    pixel_px : Array
        (2,): the target's corrected pixel, by the distortion map.
    tcp : Array
        (6,): rotation vector (rad) and translation (mm) from the calibrated to the true guide frame.
    arm : Array
        (2, 6): the same, from the pose that the arm reported to the true one, during the exposure and at the goal.
    bore_mm : Array
        (2,): along guide x and y, the bore's offset at the big ring against the small one.
    depth_mm : float
        By how much deeper the target is.
    """

    pixel_px: Array
    tcp: Array
    arm: Array
    bore_mm: Array
    depth_mm: float


def aim_error(
    truth: View, seen: View, errors: AimErrors, guide: Guide, pixel_corrected: Array, depth_mm: float
) -> Array:
    """Angle and position error of the needle after the move.

    Parameters
    ----------
    truth, seen : View
        As it is, and as it was registered.
    errors : AimErrors
        Everything else.
    guide : Guide
        Separation, mm: as it is.
    pixel_corrected : Array
        (2,): the target, where a perfect map takes it.
    depth_mm : float
        Below the big ring.

    Returns
    -------
    Array
        (6,): angle vector (rad) and position vector (mm) of (12) and (13), source frame.

    Notes
    -----
    The arm turns the commanded motion (2) to (7) about the TCP as it was calibrated; what it carries is the guide as it
    is: source_from_goal = source_from_guide D^-1 A^-1 M A' D, D the calibration's error, A and A' the arm's.
    """
    guide_from_goal, _ = goal(seen, pixel_corrected + errors.pixel_px)
    tcp, at_exposure, at_goal = (_transform(step) for step in (errors.tcp, *errors.arm))
    moved = np.linalg.inv(at_exposure @ tcp) @ guide_from_goal @ at_goal @ tcp
    source_from_goal = truth.source_from_guide @ moved
    bore = np.array([*-errors.bore_mm, guide.separation_mm])
    axis = source_from_goal[:3, :3] @ (bore / np.linalg.norm(bore))
    ray = ray_in_source(truth.intrinsics, pixel_corrected)
    below_mm = guide.separation_mm + depth_mm + errors.depth_mm
    place = ray * (float(np.linalg.norm(truth.source_from_guide[:3, 3])) - below_mm)
    return np.concatenate((angle_vector(axis, ray), position_vector(source_from_goal[:3, 3], axis, place)))


def _transform(step: Array) -> Array:
    """(4, 4) of a rotation vector and a translation, (6,)."""
    transform = np.eye(4)
    transform[:3, :3] = Rotation.from_rotvec(step[:3]).as_matrix()
    transform[:3, 3] = step[3:]
    return transform
