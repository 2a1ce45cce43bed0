"""How far each piece of a wire lies from its model: least squares over its pixels, the ground held as smooth as it is.

How much the ground bends is measured in the image itself: the spread of the pieces' own grounds, in all and around each
piece, less what noise makes of it, is the prior of that piece's ground (empirical Bayes).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from vision.pieces import GROUND, Pieces
from vision.wire_shape import PIXEL_VARIANCE

Array = NDArray[np.float64]

_CROSSING_SD = 0.5  # of what crosses, in its expected absorption: a wire's, a little of a ball's
DISPLAY_GAMMA = 0.8  # of display look-ups, 0.7 to 0.95: what was shown has so much of the absorption's slope
_USUAL_PIXELS = 10.0  # pixels by which a piece's own noise is drawn to the median's: those of some two unknowns
_ROUNDING = 1e-9  # relative; keeps empty pieces solvable
_AROUND = 9  # pieces, some eight wire widths, whose grounds bend about alike
_USUAL_PIECES = 4.0  # as how many pieces the usual ground counts beside those around: as many as it takes to know
_STEEPEST_SQUARE = 25.0  # of a ground's term against the usual one: five times, which is some edge and not the ground
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
    sums = _Sums.of(pieces)
    held = sums.normal + np.diag(_ROUNDING * sums.normal.trace(axis1=1, axis2=2).max() * np.ones(sums.normal.shape[1]))
    first = np.asarray(np.linalg.solve(held, sums.wanted[:, :, None])[:, :, 0], dtype=np.float64)
    usual = float(np.median(sums.noise(first)))
    held[:, [8, 9], [8, 9]] += usual / (_CROSSING_SD * expected) ** 2
    inverse = np.asarray(np.linalg.inv(held), dtype=np.float64)
    solved = (inverse @ sums.wanted[:, :, None])[:, :, 0]
    usual = float(np.median(sums.noise(solved)))
    ground = np.arange(GROUND.start + 1, GROUND.stop)
    by_noise = usual * np.diagonal(inverse, axis1=1, axis2=2)[:, ground]
    held[:, ground, ground] += usual / _bending(solved[:, ground], by_noise)
    by_shift = np.zeros_like(sums.wanted)
    by_shift[:, 1] = 1.0
    solved, by_shift = np.moveaxis(np.linalg.solve(held, np.stack((sums.wanted, by_shift), axis=2)), 2, 0)
    noise = sums.noise(solved)
    noise = (noise * sums.pixels + np.median(noise) * _USUAL_PIXELS) / (sums.pixels + _USUAL_PIXELS)
    return _offsets(pieces, solved, noise * by_shift[:, 1], blur_px)


def _bending(ground: Array, by_noise: Array) -> Array:
    """Variances (s, k) of the pieces' true grounds, whose terms (s, k) were solved with variances (s, k) by noise.

    Bone is rougher than tissue: beside the usual piece, which is their median, stand those around. None counts for more
    than an edge does, so that one thing across a wire leaves its neighbours' grounds held.
    """
    usual = (_ROBUST * np.median(np.abs(ground), axis=0)) ** 2 - np.median(by_noise, axis=0)
    usual = np.maximum(usual, _LEAST_VARIANCE)
    square = np.minimum(ground**2 - by_noise, _STEEPEST_SQUARE * usual)
    around = uniform_filter1d(square, _AROUND, axis=0, mode="nearest")
    return np.asarray(
        np.maximum((_USUAL_PIECES * usual + _AROUND * around) / (_USUAL_PIECES + _AROUND), _LEAST_VARIANCE)
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Sums:
    """What least squares needs of the pieces' pixels.

    Attributes
    ----------
    normal, wanted : Array
        (s, 10, 10) and (s, 10): weighted sums of the design's products with itself and with the values.
    energy, pixels : Array
        (s,) each: weighted sum of the values' squares; number of pixels.
    """

    normal: Array
    wanted: Array
    energy: Array
    pixels: NDArray[np.intp]

    @classmethod
    def of(cls, pieces: Pieces) -> "_Sums":
        weighted = pieces.design * pieces.weight[:, None, :]
        wanted = (weighted @ pieces.values[:, :, None])[:, :, 0]
        energy = (pieces.weight * pieces.values**2).sum(axis=1)
        pixels = np.maximum((pieces.weight > 0.0).sum(axis=1), 1)
        return cls(weighted @ pieces.design.transpose(0, 2, 1), wanted, energy, pixels)

    def noise(self, solved: Array) -> Array:
        """Variance (s,) at a pixel of weight 1 that unknowns (s, 10) leave."""
        modelled = (self.normal @ solved[:, :, None])[:, :, 0]
        left = self.energy - 2.0 * (solved * self.wanted).sum(axis=1) + (solved * modelled).sum(axis=1)
        return np.asarray(np.maximum(left, 0.0) / np.maximum(self.pixels - solved.shape[1], 1))


def _offsets(pieces: Pieces, solved: Array, variance: Array, blur_px: float) -> Offsets:
    """Of the solved unknowns (s, 10) and the variance (s,) of the second."""
    amplitude = solved[:, 0]
    measurable = amplitude > 0.0
    safe = np.where(measurable, amplitude, 1.0)
    # the detector blurs intensity: on a slope the wire's shadow moves towards the dense side by slope times variance
    slope_per_px = solved[:, GROUND.start + 1] / pieces.reach_px / DISPLAY_GAMMA
    offset_px = solved[:, 1] / safe - slope_per_px * (blur_px**2 + PIXEL_VARIANCE)
    left = pieces.values - (solved[:, None] @ pieces.design)[:, 0]
    seen = pieces.weight > 0.0
    misfit = np.sqrt((left**2 * seen).sum(axis=1) / np.maximum(seen.sum(axis=1), 1))
    return Offsets(offset_px, np.where(measurable, np.sqrt(variance) / safe, np.inf), amplitude, misfit)
