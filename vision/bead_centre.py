"""The bead's centre below the pixel: its shadow on a bending ground, with the wires and balls that cross it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.bands import Shadows
from vision.crossings import CROSSING_SD, crossings
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.offsets import DISPLAY_GAMMA
from vision.projection import View
from vision.shadows import Window
from vision.wire_model import Wire
from vision.wire_shape import PIXEL_VARIANCE, Profile, ball_profile

Array = NDArray[np.float64]

_REACH = 1.7  # radius of the pixels looked at, in bead radii
_ROUNDS = 3
_GROUND = slice(3, 9)
_TOGETHER = 2.0  # neighbouring pixels err together, more than on a wire's pieces: measured in rendered scenes
_LEAST_SD_PX = 0.03


@dataclass(frozen=True, slots=True, eq=False)
class BeadCentre:
    """Corrected pixel (2,), and its standard deviation along u and v, px."""

    centre_px: Array
    sd_px: float


def measure_bead(
    view: View,
    guide: Guide,
    start_px: Array,
    distortion: DistortionMap,
    values: NDArray[np.float32],
    shadows: Shadows,
    structure: float,
) -> BeadCentre:
    """Least squares over the pixels of the bead's shadow.

    Parameters
    ----------
    view, guide
        The present estimate.
    start_px : Array
        (2,): the centre within half a pixel, corrected.
    distortion : DistortionMap
        Places the raw pixels.
    values : NDArray[np.float32]
        Absorption (rows, columns) of the raw image.
    shadows : Shadows
        Of this image.
    structure : float
        How many times more places scatter than their pixels' noise says, by the wires.
    """
    bead = guide.bead
    if bead is None:
        raise ValueError("a guide without a bead has no bead's centre")
    place = np.array(bead.position_mm)
    depth_mm = float(view.source_from_guide[2, :3] @ place + view.source_from_guide[2, 3])
    radius_px = view.intrinsics.alpha_x_px * bead.diameter_mm / 2.0 / depth_mm
    expected = shadows.depth * bead.diameter_mm / guide.wire_diameter_mm
    profile = ball_profile(radius_px, expected, shadows.blur_px)
    reach_px = _REACH * radius_px
    window = Window.around(distortion.raw_from_corrected(start_px[None]), reach_px + 2.0, *values.shape)
    corrected = distortion.corrected_window(window.left, window.top, window.columns, window.rows).reshape(2, -1).T
    inside = np.linalg.norm(corrected - start_px, axis=1) < reach_px
    corrected, seen = corrected[inside], window.cut(values).ravel()[inside].astype(np.float64)
    crossing = crossings(view, guide, distortion, shadows, window, corrected, inside, tuple(Wire))
    centre, variance = start_px, 0.0
    for _ in range(_ROUNDS):
        step, variance = _step(corrected - centre, seen, crossing, profile, reach_px, expected, shadows.blur_px)
        centre = centre + np.clip(step, -1.0, 1.0)
    return BeadCentre(centre, max(_TOGETHER * structure * float(np.sqrt(variance)), _LEAST_SD_PX))


def _step(
    away: Array, seen: Array, crossing: Array, profile: Profile, reach_px: float, expected: float, blur_px: float
) -> tuple[Array, float]:
    """Shift (2,) of the bead and the mean variance of its coordinates, px^2."""
    distance = np.maximum(np.linalg.norm(away, axis=1), 1e-6)
    uphill = -profile.slopes(distance)[:, None] * away / distance[:, None]
    x, y = (away / reach_px).T
    ground = np.column_stack((np.ones_like(x), x, y, x * x, x * y, y * y))
    design = np.column_stack((profile.heights(distance), uphill, ground, crossing))
    weight = np.exp(-expected * design[:, 0])  # quanta are fewer behind the bead
    normal = (design * weight[:, None]).T @ design
    for _ in range(2):  # first without, then with what is known of the crossing: that takes the noise
        solved = np.linalg.solve(normal + 1e-9 * np.eye(len(normal)), (design * weight[:, None]).T @ seen)
        left = seen - design @ solved
        noise = float((weight * left**2).sum()) / max(len(seen) - len(normal), 1)
        held = np.zeros(len(normal))
        held[_GROUND.stop :] = noise / (CROSSING_SD * expected) ** 2
        normal = normal + np.diag(held)
    slope_per_px = solved[[4, 5]] / reach_px / DISPLAY_GAMMA
    height = max(float(solved[0]), 0.1 * expected)
    variances = noise * np.diag(np.linalg.inv(normal))[1:3] / height**2
    return solved[1:3] / height - slope_per_px * (blur_px**2 + PIXEL_VARIANCE), float(variances.mean())
