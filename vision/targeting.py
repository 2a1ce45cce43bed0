"""Where the guide must go so that its axis holds the X-ray source and the target: eq. (2) to (7)."""

import math
from dataclasses import dataclass
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from vision.alignment import check_depth, goal, ray_in_source
from vision.devices import DetectorKind
from vision.gates import check_aim
from vision.projection import View
from vision.refusal import Refusal, RefusalCode
from vision.registered import DEFAULT_DEPTH_MM, PixelSpace, PredictedError, Registration
from vision.trust import check_trust_in_files
from vision.uncertainty import predicted_error

Array = NDArray[np.float64]

_INVERSE_WITHIN_PX = 0.01  # a corrected pixel mapped to raw and back


@dataclass(frozen=True, slots=True, eq=False)
class PickedPixel:
    """One pixel (2,) in both grids of its image."""

    raw: Array
    corrected: Array


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
    """The motion that brings the guide's axis onto the ray of a pixel.

    Parameters
    ----------
    registration : Registration
        Of the image in which the pixel was picked.
    pixel : tuple
        (u, v) in `space`.
    space : PixelSpace
        Raw or corrected grid of that image.
    depth_mm : float
        Depth of the target below the big ring, for the bounds; the motion does not depend on it.

    Returns
    -------
    Targeting or Refusal
        `target_not_finite`, `target_outside_image`, `target_not_reachable`, `predicted_error_too_high` where the bounds
        at this pixel and depth reach what counts as a wrong aim, or `guide_mismatch` where the aim hangs on one word of
        the device files.
    """
    picked = locate(registration, pixel, space)
    if isinstance(picked, Refusal):
        return picked
    view, guide = registration.view(), registration.guide
    refused = check_depth(view, guide, depth_mm) or _check_in_front(view, picked.corrected)
    if refused:
        return refused
    guide_from_goal, rotation_vector = goal(view, picked.corrected)
    rotation_rad = float(np.linalg.norm(rotation_vector))
    predicted = predicted_error(view, registration.covariance, guide, picked.corrected, depth_mm)
    unsure = check_aim(predicted) or check_trust_in_files(registration, picked.corrected, depth_mm)
    if unsure is not None:
        return unsure
    return Targeting(
        target_raw_px=picked.raw,
        target_corrected_px=picked.corrected,
        depth_mm=depth_mm,
        guide_from_goal=guide_from_goal,
        translation_mm=guide_from_goal[:3, 3].copy(),
        rotation_axis=rotation_vector / rotation_rad if rotation_rad > 0.0 else np.array([1.0, 0.0, 0.0]),
        rotation_rad=rotation_rad,
        predicted_error_95=predicted,
    )


def locate(registration: Registration, pixel: tuple[float, float], space: PixelSpace) -> PickedPixel | Refusal:
    """A pixel picked in `space` in both grids of the registration's image, if it lies in the image (H08)."""
    picked = np.array([pixel], dtype=np.float64)
    if not np.isfinite(picked).all():
        return Refusal(RefusalCode.TARGET_NOT_FINITE, "the target pixel is no pair of numbers")
    match space:
        case PixelSpace.RAW:
            outside = _check_inside(registration, picked[0])
            return outside or PickedPixel(picked[0], registration.distortion.corrected_from_raw(picked)[0])
        case PixelSpace.CORRECTED:
            raw = _raw_from_corrected(registration, picked)
            return raw if isinstance(raw, Refusal) else PickedPixel(raw, picked[0])
        case _:
            assert_never(space)


def _raw_from_corrected(registration: Registration, picked: Array) -> Array | Refusal:
    """Raw pixel (2,) of a corrected one (1, 2), if the map has one there and it lies in the image."""
    distortion = registration.distortion
    try:
        with np.errstate(all="ignore"):  # far outside the plate the polynomial may run off
            raw = distortion.raw_from_corrected(picked)
            distance_px = float(np.linalg.norm(distortion.corrected_from_raw(raw) - picked))
    except np.linalg.LinAlgError:
        distance_px = math.inf
    if not distance_px <= _INVERSE_WITHIN_PX:
        message = "the target's corrected pixel has no raw pixel: distance of the nearest found, px"
        return Refusal(RefusalCode.TARGET_OUTSIDE_IMAGE, message, distance_px, _INVERSE_WITHIN_PX)
    return _check_inside(registration, raw[0]) or raw[0]


def _check_inside(registration: Registration, raw: Array) -> Refusal | None:
    """A refusal unless the raw pixel lies in the image and, on an intensifier, in its round field."""
    rows, columns = registration.image.rows, registration.image.columns
    half = np.array([columns, rows]) / 2.0
    from_centre = np.abs(raw - (half - 0.5))
    beyond_px = float((from_centre - half).max())
    if registration.carm.detector is DetectorKind.INTENSIFIER:
        beyond_px = max(beyond_px, float(np.linalg.norm(from_centre) - half.max()))
    if beyond_px <= 0.0:
        return None
    return Refusal(RefusalCode.TARGET_OUTSIDE_IMAGE, "the target lies outside the image, by px", beyond_px, 0.0)


def _check_in_front(view: View, pixel_corrected: Array) -> Refusal | None:
    """A refusal where the guide points against the ray: the minimal rotation would have no axis."""
    cosine = float(view.source_from_guide[:3, 2] @ ray_in_source(view.intrinsics, pixel_corrected))
    if cosine > 0.0:
        return None
    message = "the guide's axis points against the target ray, cosine"
    return Refusal(RefusalCode.TARGET_NOT_REACHABLE, message, cosine, 0.0)
