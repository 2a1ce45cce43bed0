"""How far each piece of a wire lies from its model: least squares over its pixels, the ground held as smooth as it is.

How much the ground bends is measured in the image itself: the spread of the pieces' own grounds, less what noise makes
of it, is the prior of each of them (empirical Bayes).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.bands import GROUND, Pieces
from vision.wire_shape import PIXEL_VARIANCE

Array = NDArray[np.float64]

_CROSSING_SD = 0.5  # of what crosses, in its expected absorption: a wire's, a little of a ball's
DISPLAY_GAMMA = 0.8  # of display look-ups, 0.7 to 0.95: what was shown has so much of the absorption's slope
_USUAL_PIXELS = 10.0  # pixels by which a piece's own noise is drawn to the median's: those of some two unknowns
_ROUNDING = 1e-9  # relative; keeps empty pieces solvable
_LEAST_VARIANCE = 1e-6  # of a ground's term: a thousandth of absorption
_ROBUST = 1.4826  # standard deviation of a Gaussian by its median absolute deviation


@dataclass(frozen=True, slots=True, eq=False)
class Offsets:
    """Of each piece (s,): shift along the normal with its standard deviation by noise, px; absorption; misfit.

    Pieces that cannot be measured have an infinite standard deviation.
    """

    offset_px: Array
    sd_px: Array
    amplitude: Array
    misfit: Array


def measure_offsets(pieces: Pieces, expected: float, blur_px: float) -> Offsets:
    """Solve every piece.

    Parameters
    ----------
    pieces : Pieces
        Cut by the present estimate.
    expected : float
        Absorption of a wire.
    blur_px : float
        Standard deviation of the detector's blur.
    """
    weighted = pieces.design * pieces.weight[:, :, None]
    normal = weighted.transpose(0, 2, 1) @ pieces.design
    wanted = (weighted.transpose(0, 2, 1) @ pieces.values[:, :, None])[:, :, 0]
    pixels = np.maximum((pieces.weight > 0.0).sum(axis=1), 1)
    held = normal + np.diag(_ROUNDING * normal.trace(axis1=1, axis2=2).max() * np.ones(normal.shape[1]))
    solved, noise = _solved(pieces, held, wanted, pixels)
    usual = float(np.median(noise))
    held[:, [8, 9], [8, 9]] += usual / (_CROSSING_SD * expected) ** 2
    solved, noise = _solved(pieces, held, wanted, pixels)
    usual = float(np.median(noise))
    ground = np.arange(GROUND.start + 1, GROUND.stop)
    spread = (_ROBUST * np.median(np.abs(solved[:, ground]), axis=0)) ** 2
    by_noise = usual * np.median(np.diagonal(np.linalg.inv(held), axis1=1, axis2=2)[:, ground], axis=0)
    held[:, ground, ground] += usual / np.maximum(spread - by_noise, _LEAST_VARIANCE)
    solved, noise = _solved(pieces, held, wanted, pixels)
    noise = (noise * pixels + np.median(noise) * _USUAL_PIXELS) / (pixels + _USUAL_PIXELS)
    return _offsets(pieces, held, solved, noise, blur_px)


def _solved(pieces: Pieces, normal: Array, wanted: Array, pixels: NDArray[np.intp]) -> tuple[Array, Array]:
    """Unknowns (s, 10) and the noise's variance (s,) at a pixel of weight 1."""
    solved = np.asarray(np.linalg.solve(normal, wanted[:, :, None]), dtype=np.float64)
    left = pieces.values - (pieces.design @ solved)[:, :, 0]
    free = np.maximum(pixels - normal.shape[1], 1)
    return solved[:, :, 0], (pieces.weight * left**2).sum(axis=1) / free


def _offsets(pieces: Pieces, normal: Array, solved: Array, noise: Array, blur_px: float) -> Offsets:
    amplitude = solved[:, 0]
    measurable = amplitude > 0.0
    safe = np.where(measurable, amplitude, 1.0)
    # the detector blurs intensity: on a slope the wire's shadow moves towards the dense side by slope times variance
    slope_per_px = solved[:, GROUND.start + 1] / pieces.reach_px / DISPLAY_GAMMA
    offset_px = solved[:, 1] / safe - slope_per_px * (blur_px**2 + PIXEL_VARIANCE)
    variance = noise * np.linalg.inv(normal)[:, 1, 1] / safe**2
    left = pieces.values - (pieces.design @ solved[:, :, None])[:, :, 0]
    seen = pieces.weight > 0.0
    misfit = np.sqrt((left**2 * seen).sum(axis=1) / np.maximum(seen.sum(axis=1), 1))
    return Offsets(offset_px, np.where(measurable, np.sqrt(variance), np.inf), amplitude, misfit)
