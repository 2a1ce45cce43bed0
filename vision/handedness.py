"""Handedness by a nudge (H05), for a guide without a bead: two images with a known motion of the arm between them.

Rings and line fit a mirrored image perfectly, with a pose that is mirrored too: the motion between two such poses is
the arm's, its part along guide y reversed. x, z and a turn about y look alike in a mirror and prove nothing.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.motion_agreement import CHI_SQUARE_LIMIT, MotionErrors, compare_motion
from vision.refusal import Refusal, RefusalCode
from vision.registered import Registration

Array = NDArray[np.float64]

LEAST_NUDGE_MM = 5.0  # along guide y
CLEAR_WIN = 40.0  # difference of the two chi-squares: the likelihood ratio that the bead's test asks for
_MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])


@dataclass(frozen=True, slots=True)
class Handedness:
    """What proves it: the nudge along guide y, and the chi-square of the motion against the arm's and its mirror's."""

    nudge_mm: float
    chi_square: float
    mirrored_chi_square: float


def prove_handedness(
    before: Registration, after: Registration, before_from_after: Array, errors: MotionErrors
) -> Handedness | Refusal:
    """Decide whether two images are mirrored.

    Parameters
    ----------
    before, after : Registration
        By contour, of two images of one C-arm pose, as if neither were mirrored.
    before_from_after : Array
        (4, 4), mm: the guide's pose during the second exposure in its own frame during the first, by the arm.
    errors : MotionErrors
        Of the arm and of the TCP calibration.

    Returns
    -------
    Handedness or Refusal
        `mirrored` where the rings did the mirror image of what the arm did, `handedness_unproved` where the nudge was
        too small, or neither agrees clearly: the C-arm may have moved.
    """
    nudge_mm = abs(float(before_from_after[1, 3]))
    if not nudge_mm >= LEAST_NUDGE_MM:
        message = "the guide was moved too little along its own y between the two images (mm)"
        return Refusal(RefusalCode.HANDEDNESS_UNPROVED, message, nudge_mm, LEAST_NUDGE_MM)
    mirrored_motion = _MIRROR @ before_from_after @ _MIRROR
    straight, mirrored = (
        compare_motion(before, after, motion, errors).chi_square for motion in (before_from_after, mirrored_motion)
    )
    if _clearly(straight, mirrored):
        return Handedness(nudge_mm, straight, mirrored)
    if _clearly(mirrored, straight):
        message = "the images are mirrored: the guide moved the other way than the arm (chi-square)"
        return Refusal(RefusalCode.MIRRORED, message, straight, CHI_SQUARE_LIMIT)
    message = "the guide moved neither as the arm did nor as its mirror image would (chi-square of the better)"
    return Refusal(RefusalCode.HANDEDNESS_UNPROVED, message, min(straight, mirrored), CHI_SQUARE_LIMIT)


def _clearly(one: float, other: float) -> bool:
    return one <= CHI_SQUARE_LIMIT and other - one >= CLEAR_WIN
