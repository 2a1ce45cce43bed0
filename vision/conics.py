"""Ellipses and conic matrices; true ring centres and the 12 fiducials from the two ellipses and the line."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.devices import Guide
from vision.projection import Intrinsics
from vision.refusal import Refusal

Array = NDArray[np.float64]

FIDUCIAL_NAMES = (
    "small_centre",
    "small_x_plus",
    "small_x_minus",
    "small_y_plus",
    "small_y_minus",
    "big_centre",
    "big_x_plus",
    "big_x_minus",
    "big_y_plus",
    "big_y_minus",
    "line_start",
    "line_end",
)


@dataclass(frozen=True, slots=True)
class Ellipse:
    """An ellipse in corrected pixels; `angle_rad` turns u towards v up to the major axis, in (-pi/2, pi/2]."""

    centre_px: tuple[float, float]
    semi_axes_px: tuple[float, float]
    angle_rad: float


@dataclass(frozen=True, slots=True)
class RingPair:
    """The ellipses of the two rings' wire centre lines, corrected pixels."""

    small: Ellipse
    big: Ellipse


@dataclass(frozen=True, slots=True, eq=False)
class RingCentres:
    """Projections (2,) of the true ring centres, corrected pixels, and the vanishing line (3,) of the rings' planes."""

    small_px: Array
    big_px: Array
    vanishing_line: Array


def fit_ellipse(points: Array) -> Ellipse | None:
    """Least-squares ellipse of points (n, 2), corrected pixels; None where no ellipse fits them."""
    raise NotImplementedError


def conic_from_ellipse(ellipse: Ellipse) -> Array:
    """Symmetric (3, 3) conic of an ellipse, negative inside."""
    raise NotImplementedError


def ellipse_from_conic(conic: Array) -> Ellipse | None:
    """The ellipse of a (3, 3) conic; None where the conic is no real ellipse."""
    raise NotImplementedError


def pole(conic: Array, line: Array) -> Array:
    """Homogeneous point (3,) whose polar with respect to `conic` is `line` (3,)."""
    raise NotImplementedError


def polar(conic: Array, point: Array) -> Array:
    """Homogeneous line (3,), polar of the homogeneous point (3,)."""
    raise NotImplementedError


def true_centres(rings: RingPair, guide: Guide, nominal: Intrinsics) -> RingCentres:
    """Projections of the ring centres by the iteration of docs/method.md (four rounds, nominal intrinsics)."""
    raise NotImplementedError


def fiducials(
    rings: RingPair, line_start_px: Array, line_end_px: Array, guide: Guide, nominal: Intrinsics
) -> dict[str, Array] | Refusal:
    """The 12 fiducials (2,), corrected pixels, in the order of `FIDUCIAL_NAMES`."""
    raise NotImplementedError
