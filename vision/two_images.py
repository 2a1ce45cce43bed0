"""What the verification image tells of the room beside the guide's error (H03, H34), held against the image before."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.anatomy_shift import AnatomyShift, Exposed, compare_anatomy
from vision.corrected_image import CorrectedImage, correct
from vision.motion_agreement import MotionAgreement, MotionErrors, compare_motion
from vision.refusal import Refusal
from vision.registered import PixelSpace, Registration
from vision.targeting import locate
from vision.xray import XrayImage

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Before:
    """The image from which the move was planned, its registration, and the guide's motion since then by the arm.

    `before_from_after` is the guide's pose during the second exposure in its own frame during the first, (4, 4), mm.
    """

    image: XrayImage
    registration: Registration
    before_from_after: Array
    errors: MotionErrors


@dataclass(frozen=True, slots=True)
class TwoImages:
    """Both comparisons."""

    motion: MotionAgreement
    anatomy: AnatomyShift


def compare_images(
    before: Before, seen: CorrectedImage, registration: Registration, raw_px: tuple[float, float], depth_mm: float
) -> TwoImages | Refusal:
    """Compare the image of a verification with the one before.

    Parameters
    ----------
    before : Before
        What the move was planned from.
    seen, registration
        The verification's image, corrected, and its registration; by contour, as the one before.
    raw_px : tuple
        (u, v) of the target, raw pixel, the same in both.
    depth_mm : float
        Of the target below the big ring.

    Returns
    -------
    TwoImages or Refusal
        Any refusal of the first image's correction, or of the target in it.
    """
    picked = locate(before.registration, raw_px, PixelSpace.RAW)
    if isinstance(picked, Refusal):
        return picked
    first = correct(before.image, before.registration.carm)
    if isinstance(first, Refusal):
        return first
    return TwoImages(
        motion=compare_motion(before.registration, registration, before.before_from_after, before.errors),
        anatomy=compare_anatomy(
            Exposed(first, before.registration), Exposed(seen, registration), picked.corrected, depth_mm
        ),
    )
