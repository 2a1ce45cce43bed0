"""Where the guide must go so that its axis holds the X-ray source and the target: eq. (2) to (7)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.refusal import Refusal
from vision.registered import DEFAULT_DEPTH_MM, PixelSpace, PredictedError, Registration

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Targeting:
    """The commanded motion, in the guide frame of the image.

    Attributes
    ----------
    target_raw_px, target_corrected_px : Array
        (2,) each: the same target in both grids.
    guide_from_goal : Array
        (4, 4), mm.
    rotation_axis : Array
        (3,), unit length; any direction where `rotation_rad` is 0.
    """

    target_raw_px: Array
    target_corrected_px: Array
    depth_mm: float
    guide_from_goal: Array
    translation_mm: Array
    rotation_axis: Array
    rotation_rad: float
    predicted_error_95: PredictedError


def target(
    registration: Registration, pixel: tuple[float, float], space: PixelSpace, depth_mm: float = DEFAULT_DEPTH_MM
) -> Targeting | Refusal:
    """The motion that brings the guide's axis onto the ray of `pixel`, picked in `space`."""
    raise NotImplementedError
