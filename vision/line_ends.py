"""The two ends of the indicator line: the pixels around each, explained by a wire that ends there.

The end is cut square, so that its shadow is the wire's profile across times a step along, blurred as intensity. What
crosses it is part of the explanation. How surely an end is seen, its likelihood over all places near it tells: bone
that looks like an end as well makes it wide, and such an end is not told.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from vision.bands import Shadows
from vision.crossings import CROSSING_SD, bead_shadow, crossings, wire_radius_px
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.offsets import DISPLAY_GAMMA
from vision.projection import View, project
from vision.shadows import Window
from vision.wire_model import Wire, feet
from vision.wire_shape import PIXEL_VARIANCE, wire_profile

Array = NDArray[np.float64]

_REACH_PX = 10.0  # along the line, each way
_ACROSS = 1.2  # half width of the pixels looked at, in wire widths
_STEP_PX = 0.25
_PLACES_PX = np.arange(-8.0, 8.0 + _STEP_PX / 2.0, _STEP_PX)  # where an end is looked for, from its projection
_DEPTH_SD = 0.15  # of the line's absorption, in that of the rings: dark ground and display take so much from it
_LEAST_SD_MM = 0.05  # a cut is square and free of burr to that
_GREATEST_SD_PX = 1.0  # beyond it an end is not seen
_TOGETHER = 3.0  # factor of a place's standard deviation, since pixels err together: measured in rendered scenes
_SOLVABLE = 1e-9  # added to normal equations of columns of height 1


@dataclass(frozen=True, slots=True)
class LineEnd:
    """A measured end: x of the fiducial in the guide frame, mm; how far beyond its projection it lies, and sd, px."""

    x_mm: float
    excess_px: float
    amplitude: float
    sd_px: float


@dataclass(frozen=True, slots=True, eq=False)
class _Patch:
    """Pixels around an end.

    Attributes
    ----------
    beyond_px : Array
        (n,): distance beyond the end's projection, along the line.
    profile : Array
        (n,): share of the beam that the line takes there where it has not ended.
    seen : Array
        (n,): absorption.
    others : Array
        (n, k): columns of the ground, then of what crosses, `crossing_count` of these.
    depth : float
        Absorption at a wire's middle.
    blur_px : float
        Standard deviation of the step along the line, the obliquely seen cut within it.
    """

    beyond_px: Array
    profile: Array
    seen: Array
    others: Array
    crossing_count: int
    depth: float
    blur_px: float


def measure_line_ends(
    view: View, guide: Guide, distortion: DistortionMap, values: NDArray[np.float32], shadows: Shadows
) -> list[LineEnd]:
    """Those ends that are seen to a pixel; excess counts outwards.

    Parameters
    ----------
    view, guide
        The present estimate, within some pixels.
    distortion : DistortionMap
        Places the raw pixels.
    values : NDArray[np.float32]
        Absorption (rows, columns) of the raw image.
    shadows : Shadows
        Of this image.
    """
    per_mm = 2.0 * wire_radius_px(view, guide) / guide.wire_diameter_mm
    ends = []
    for x_mm, outwards in ((guide.line_start_mm, -1.0), (guide.line_end_mm, 1.0)):
        end = _measured(_patch(view, guide, distortion, values, shadows, x_mm, outwards), x_mm, _LEAST_SD_MM * per_mm)
        if end.sd_px <= _GREATEST_SD_PX:
            ends.append(end)
    return ends


def _patch(
    view: View,
    guide: Guide,
    distortion: DistortionMap,
    values: NDArray[np.float32],
    shadows: Shadows,
    x_mm: float,
    outwards: float,
) -> _Patch:
    radius_px = wire_radius_px(view, guide)
    middle = distortion.raw_from_corrected(project(view, np.array([[x_mm, 0.0, 0.0]])))
    window = Window.around(middle, _REACH_PX + 2.0 * _ACROSS * radius_px, *values.shape)
    corrected = distortion.corrected_window(window.left, window.top, window.columns, window.rows).reshape(2, -1).T
    at = feet(view, guide, Wire.LINE, corrected)
    beyond_px, across_px = outwards * (at.along - x_mm) * at.speed_px, at.distance_px
    reach_px = 2.0 * _ACROSS * radius_px
    inside = (np.abs(beyond_px) < _REACH_PX) & (np.abs(across_px) < reach_px)
    rings = (Wire.SMALL_RING, Wire.BIG_RING)
    crossing = np.hstack(
        (
            crossings(view, guide, distortion, shadows, window, corrected[inside], inside, rings),
            bead_shadow(view, guide, distortion, shadows, window, inside),
        )
    )
    sine = float(view.source_from_guide[2, 0])  # of the line's inclination: by it the round cut is seen from the side
    height = wire_profile(radius_px, shadows.depth, shadows.blur_px).heights(across_px[inside])
    return _Patch(
        beyond_px=beyond_px[inside],
        profile=-np.expm1(-shadows.depth / DISPLAY_GAMMA * height),
        seen=window.cut(values).ravel()[inside].astype(np.float64),
        others=np.hstack((_ground(beyond_px[inside] / _REACH_PX, across_px[inside] / reach_px), crossing)),
        crossing_count=crossing.shape[1],
        depth=shadows.depth,
        blur_px=float(np.sqrt(shadows.blur_px**2 + PIXEL_VARIANCE + (sine * radius_px) ** 2 / 4.0)),
    )


def _ground(along: Array, across: Array) -> Array:
    """Terms (n, 10) of a ground of third order."""
    powers = [(np.ones_like(axis), axis, axis * axis, axis * axis * axis) for axis in (along, across)]
    return np.column_stack([powers[0][i] * powers[1][j] for i in range(4) for j in range(4 - i)])


def _shadow(patch: _Patch, place_px: Array) -> Array:
    """The shadow (k, n) of a line that ends at places (k, 1), 1 at its middle."""
    inner = 0.5 * (1.0 - erf((patch.beyond_px - place_px) / (np.sqrt(2.0) * patch.blur_px)))
    return np.asarray(-DISPLAY_GAMMA * np.log1p(-patch.profile * inner) / patch.depth)


def _measured(patch: _Patch, x_mm: float, least_sd_px: float) -> LineEnd:
    """The likeliest place and the likelihood's spread about it, the line's absorption held to the rings'."""
    free, noise = max(len(patch.seen) - patch.others.shape[1] - 2, 1), 0.0
    shadows = _shadow(patch, _PLACES_PX[:, None])
    for _ in range(2):  # first without, then with what is known of the absorption: that takes the noise
        left, amplitude = _explained(patch, shadows, noise)
        noise = float(left.min()) / free
    chance = np.exp(-(left - left.min()) / (2.0 * _TOGETHER**2 * max(noise, _SOLVABLE)))
    chance /= chance.sum()
    place_px = _likeliest(left)
    spread_px = float(np.sqrt(chance @ (_PLACES_PX - place_px) ** 2))
    return LineEnd(x_mm, place_px, float(chance @ amplitude), float(np.hypot(spread_px, least_sd_px)))


def _likeliest(left: Array) -> float:
    """The place that leaves least, between those looked at by a parabola through three of them (k,)."""
    best = int(np.argmin(left))
    if not 0 < best < len(left) - 1:
        return float(_PLACES_PX[best])
    before, here, after = left[best - 1 : best + 2]
    return float(_PLACES_PX[best] + 0.5 * (before - after) / (before - 2.0 * here + after) * _STEP_PX)


def _explained(patch: _Patch, shadows: Array, noise: float) -> tuple[Array, Array]:
    """For each of the ends' shadows (k, n): what it leaves of the pixels, squared, and the line's absorption."""
    count = patch.others.shape[1]
    held = np.full(count, _SOLVABLE)
    held[count - patch.crossing_count :] += noise / (CROSSING_SD * patch.depth) ** 2
    # what is known beforehand stands below the pixels as further rows
    basis = np.linalg.qr(np.vstack((patch.others, np.diag(np.sqrt(held)))))[0]
    seen = np.concatenate((patch.seen, np.zeros(count)))
    shadows = np.hstack((shadows, np.zeros((len(shadows), count))))
    left = seen - basis @ (basis.T @ seen)
    shadows -= (shadows @ basis) @ basis.T
    match, size, known = shadows @ left, (shadows**2).sum(axis=1), noise / (_DEPTH_SD * patch.depth) ** 2
    amplitude = (match + known * patch.depth) / (size + known + _SOLVABLE)
    squares = left @ left - 2.0 * amplitude * match + amplitude**2 * size + known * (amplitude - patch.depth) ** 2
    return np.asarray(squares), np.asarray(amplitude)
