"""How well the guide points at the target, from one image after the move: eq. (8) to (13), twice.

`paper` is the paper's own figure. It takes ellipse centres for ring centres, hence a bias of 0.013 deg and 0.041 mm per
degree between the guide's axis and the detector's normal. `contour` is the same angle and distance from a full
registration of the image. Their agreement (H33) is judged with a centre-corrected paper figure whose K comes from the
C-arm file: the K of the fit absorbs wrong radii, and both would be wrong together.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.alignment import angle_vector, check_depth, position_vector, ray_in_source, target_in_source
from vision.conics import RingCentres, RingPair, depth_ratio, true_centres
from vision.devices import CArm, Guide
from vision.projection import Intrinsics, nominal_intrinsics
from vision.refusal import Refusal
from vision.registered import DEFAULT_DEPTH_MM, Method, PixelSpace, PredictedError, Registration
from vision.registration import register
from vision.targeting import locate
from vision.trust import check_trust_in_files
from vision.uncertainty import alignment_bounds
from vision.xray import XrayImage

Array = NDArray[np.float64]

_ANGLE_LIMIT_RAD = math.radians(0.02)
_ANGLE_LIMIT_PER_ANGLE = 0.09
_POSITION_LIMIT_MM = 0.05
_POSITION_LIMIT_MM_PER_RAD = 0.25 * 180.0 / math.pi  # 0.25 mm per degree


@dataclass(frozen=True, slots=True, eq=False)
class ErrorVectors:
    """Errors as vectors (3,) in the source frame: from the guide's axis to the target ray (rad), to the target (mm)."""

    angle: Array
    position: Array

    def magnitudes(self) -> "AlignmentError":
        """Their lengths."""
        return AlignmentError(float(np.linalg.norm(self.angle)), float(np.linalg.norm(self.position)))


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
    """Both figures for a target.

    Parameters
    ----------
    image : XrayImage
        Taken after the move.
    guide, carm
        The device files.
    pixel : tuple
        (u, v) of the target in this image, in `space`.
    depth_mm : float
        Depth of the target below the big ring.

    Returns
    -------
    Evaluation or Refusal
        Any refusal of the registration or of the target; `guide_mismatch` where the error hangs on one word of the
        device files.
    """
    registration = register(image, guide, carm, Method.CONTOUR)
    if isinstance(registration, Refusal):
        return registration
    return evaluate_registration(registration, pixel, space, depth_mm)


def evaluate_registration(
    registration: Registration, pixel: tuple[float, float], space: PixelSpace, depth_mm: float = DEFAULT_DEPTH_MM
) -> Evaluation | Refusal:
    """The same from a contour registration that exists already; ValueError for one by another method."""
    if registration.method is not Method.CONTOUR:
        raise ValueError("an evaluation needs a contour registration")
    guide, rings = registration.guide, registration.rings
    picked = locate(registration, pixel, space)
    if isinstance(picked, Refusal):
        return picked
    view, here = registration.view(), np.eye(4)
    refused = check_depth(view, guide, depth_mm) or check_trust_in_files(registration, picked.corrected, depth_mm, here)
    if refused:
        return refused
    image, pixel_size_mm = registration.image, registration.distortion.pixel_size_mm
    nominal = nominal_intrinsics(registration.carm, image.rows, image.columns, pixel_size_mm)
    centres = true_centres(rings, guide, nominal)
    if isinstance(centres, Refusal):
        return centres
    contour = contour_errors(registration, picked.corrected, depth_mm)
    raw = paper_errors(ellipse_centres(rings, guide), registration.intrinsics, guide, picked.corrected, depth_mm)
    corrected = paper_errors(centres, nominal, guide, picked.corrected, depth_mm)
    difference = ErrorVectors(contour.angle - corrected.angle, contour.position - corrected.position).magnitudes()
    limit = agreement_limit(contour.magnitudes())
    return Evaluation(
        registration=registration,
        contour=contour.magnitudes(),
        contour_bounds_95=alignment_bounds(view, registration.covariance, guide, picked.corrected, depth_mm, here),
        paper=raw.magnitudes(),
        paper_corrected=corrected.magnitudes(),
        difference=difference,
        limit=limit,
        agree=difference.angle_rad <= limit.angle_rad and difference.position_mm <= limit.position_mm,
    )


def agreement_limit(contour: AlignmentError) -> AlignmentError:
    """How far the figures may differ (H33): 0.02 deg + 0.09 theta, and 0.05 mm + 0.25 mm per degree of theta."""
    return AlignmentError(
        angle_rad=_ANGLE_LIMIT_RAD + _ANGLE_LIMIT_PER_ANGLE * contour.angle_rad,
        position_mm=_POSITION_LIMIT_MM + _POSITION_LIMIT_MM_PER_RAD * contour.angle_rad,
    )


def contour_errors(registration: Registration, pixel_corrected: Array, depth_mm: float) -> ErrorVectors:
    """Errors of the registered guide's axis for the target at `pixel_corrected` (2,); eq. (12), (13)."""
    view = registration.view()
    axis, on_axis = view.source_from_guide[:3, 2], view.source_from_guide[:3, 3]
    target = target_in_source(view, pixel_corrected, registration.guide, depth_mm)
    angle = angle_vector(axis, ray_in_source(view.intrinsics, pixel_corrected))
    return ErrorVectors(angle, position_vector(on_axis, axis, target))


def ellipse_centres(rings: RingPair, guide: Guide) -> RingCentres:
    """What the paper takes for the ring centres: the centres of the ellipses, and (10) from their semi-major axes."""
    small, big = np.array(rings.small.centre_px), np.array(rings.big.centre_px)
    return RingCentres(small, big, vanishing_line=np.array([0.0, 0.0, 1.0]), depth_ratio=depth_ratio(rings, guide))


def paper_errors(
    centres: RingCentres, intrinsics: Intrinsics, guide: Guide, pixel_corrected: Array, depth_mm: float
) -> ErrorVectors:
    """Errors from the two ring centres alone.

    Parameters
    ----------
    centres : RingCentres
        True ones, or the ellipses' as in the paper.
    intrinsics : Intrinsics
        K, corrected pixels.
    guide : Guide
        Separation, mm.
    pixel_corrected : Array
        (2,), corrected pixel of the target.
    depth_mm : float
        Depth of the target below the big ring.

    Notes
    -----
    (8), (9), (10) give k = Z_P / Z_Q; |QP| = Ld (11) gives the scale; then (12) and (13).
    """
    matrix = intrinsics.matrix()
    q = np.linalg.solve(matrix, (*centres.small_px, 1.0))
    p = centres.depth_ratio * np.linalg.solve(matrix, (*centres.big_px, 1.0))
    small_ring = q * (guide.separation_mm / np.linalg.norm(q - p))
    axis = (q - p) / np.linalg.norm(q - p)
    ray = ray_in_source(intrinsics, pixel_corrected)
    target = ray * (np.linalg.norm(small_ring) - guide.separation_mm - depth_mm)
    return ErrorVectors(angle_vector(axis, ray), position_vector(small_ring, axis, target))
