"""How well the guide points at the target, from one image after the move: eq. (8) to (13), twice."""

from dataclasses import dataclass

from vision.devices import CArm, Guide
from vision.refusal import Refusal
from vision.registered import DEFAULT_DEPTH_MM, PixelSpace, PredictedError, Registration
from vision.xray import XrayImage


@dataclass(frozen=True, slots=True)
class AlignmentError:
    """Angle between the guide's axis and the target ray, and distance of the target from the axis at its depth."""

    angle_rad: float
    position_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """The contour figure with its 95 % bounds, the raw figure of the paper, and whether the two agree (H33).

    `difference` is the vector difference between contour and centre-corrected paper, `limit` its bound. The contour
    registration is kept, so that a correction needs no new exposure.
    """

    registration: Registration
    contour: AlignmentError
    contour_bounds_95: PredictedError
    paper: AlignmentError
    paper_corrected: AlignmentError
    difference: AlignmentError
    limit: AlignmentError
    agree: bool


def evaluate(
    image: XrayImage,
    guide: Guide,
    carm: CArm,
    pixel: tuple[float, float],
    space: PixelSpace,
    depth_mm: float = DEFAULT_DEPTH_MM,
) -> Evaluation | Refusal:
    """Both figures for the target `pixel`, picked in `space` of this image."""
    raise NotImplementedError


def evaluate_registration(
    registration: Registration, pixel: tuple[float, float], space: PixelSpace, depth_mm: float = DEFAULT_DEPTH_MM
) -> Evaluation | Refusal:
    """The same from a contour registration that exists already."""
    raise NotImplementedError
