"""How the places on the wires scatter: each on its own, together with its neighbours, and with the distortion map.

Bone and tissue beside a wire push a stretch of it to one side: by how much differs from stretch to stretch, and
neighbours err together. Both are measured in the residuals of the image; over which length is the ground's nature.
Correlation that falls exponentially along a wire has an inverse with three diagonals, and the map has few coefficients:
no matrix of all places is ever made.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

Array = NDArray[np.float64]

LEAST_NOISE_PX = 0.02  # of one place: the shadow's model is no better
SHARED_OVER = 1.5  # length in wire widths over which the common error falls to 1/e: measured in rendered scenes
_FARTHEST_PAIR = 0.1  # correlation below which two places tell nothing about the common error
_GREATEST_ALIKE = 1.0 - 1e-9  # of two places at one spot: the inverse stays finite
_MOST_SHARED = 0.95  # of the variance: some of it is each pixel's own noise
_MEDIAN_SQUARE = 0.4549  # of a Gaussian of standard deviation 1
_GREATEST_SQUARE = 22.0  # about Tukey's 4.685 standard deviations squared: what lies farther off is another thing
_USUAL_PLACES = 2.0  # how many places of the usual scatter stand beside the neighbours': some five of them differ


@dataclass(frozen=True, slots=True, eq=False)
class Neighbours:
    """Places in their order along the wires.

    Attributes
    ----------
    alike : Array
        (n - 1,): correlation of the common error of each place and the next, 0 from one wire to another. That of any
        two places is the product of all between them.
    """

    alike: Array

    @classmethod
    def of(cls, wire: NDArray[np.intp], points: Array, length_px: float) -> "Neighbours":
        """Of places (n, 2) and their wires (n,); `length_px` is that over which the correlation falls to 1/e."""
        step_px = np.linalg.norm(np.diff(points, axis=0), axis=1)
        alike = np.where(wire[1:] == wire[:-1], np.exp(-step_px / length_px), 0.0)
        return cls(np.minimum(alike, _GREATEST_ALIKE))

    def pairs(self) -> list[Array]:
        """Correlations of places 1, 2, ... apart, those too small to tell anything as 0."""
        found, far = [], self.alike
        while (far > _FARTHEST_PAIR).any():
            found.append(np.where(far > _FARTHEST_PAIR, far, 0.0))
            far = far[:-1] * self.alike[len(found) :]
        return found

    def around(self, values: Array) -> Array:
        """Sums (n,) of the others' values (n,), by their correlation."""
        total = np.zeros(len(values))
        for apart, alike in enumerate(self.pairs(), 1):
            total[:-apart] += alike * values[apart:]
            total[apart:] += alike * values[:-apart]
        return total

    def precision(self) -> Array:
        """Inverse of the correlation matrix: its diagonal, and the one above it after a place of no meaning; (2, n)."""
        apart = 1.0 - self.alike**2
        bands = np.ones((2, len(self.alike) + 1))
        bands[0, 1:] = -self.alike / apart
        bands[1, :-1] = 1.0 / apart
        bands[1, 1:] += self.alike**2 / apart
        return bands


@dataclass(frozen=True, slots=True, eq=False)
class WireNoise:
    """Standard deviation of each place (n,), px, and which share of the variances is common to neighbours."""

    sd_px: Array
    shared: float

    @classmethod
    def measured(cls, residual_px: Array, sd_px: Array, seen: NDArray[np.bool_], neighbours: Neighbours) -> "WireNoise":
        """What residuals show.

        Parameters
        ----------
        residual_px : Array
            (n,).
        sd_px : Array
            (n,): the pixels' share of them.
        seen : NDArray[np.bool_]
            (n,): which places the fit rests on.
        neighbours : Neighbours
            Of the places.

        Notes
        -----
        The pixels' share, averaged over neighbours, has the right course along the wires, since what the ground hides
        is in it too, but not the size: that is the residuals' median. Where the neighbours of a place scatter more or
        less than that, so does the place; its own residual is left to the robust weights, and places that these have
        given up tell nothing of the others.
        """
        every, there = np.ones(len(sd_px)), seen.astype(np.float64)
        usual = (sd_px**2 + neighbours.around(sd_px**2)) / (1.0 + neighbours.around(every))
        usual = np.maximum(usual, LEAST_NOISE_PX**2)
        usual *= max(float(np.median(residual_px**2 / usual)) / _MEDIAN_SQUARE, 1.0)
        square = np.minimum(residual_px**2 / usual, _GREATEST_SQUARE)
        scatter = (_USUAL_PLACES + neighbours.around(there * square)) / (_USUAL_PLACES + neighbours.around(there))
        sd_px = np.sqrt(usual * scatter)
        return cls(sd_px, _shared(np.where(seen, residual_px / sd_px, 0.0), seen, neighbours))


def _shared(deviations: Array, seen: NDArray[np.bool_], neighbours: Neighbours) -> float:
    """Which share of the variance of deviations (n,) of spread 1 neighbours have in common."""
    product = size = 0.0
    for apart, alike in enumerate(neighbours.pairs(), 1):
        product += float((deviations[:-apart] * deviations[apart:]) @ alike)
        size += float((seen[:-apart] & seen[apart:]) @ alike**2)
    return min(max(product / max(size, 1e-9), 0.0), _MOST_SHARED)


@dataclass(frozen=True, slots=True, eq=False)
class PlaceCovariance:
    """Covariance of all places' errors, px^2: S ((1 - s) 1 + s N) S + B B^T.

    S are the places' standard deviations, those of little weight taken for noisier, N the correlation of the common
    error and s its share, B the map's part.

    Attributes
    ----------
    per_sd : Array
        (n,): S^-1.
    own : float
        1 - s.
    bands : Array or None
        (2, n): 1 / (1 - s) + (s N)^-1, the diagonal below the one above it; none where nothing is shared.
    bend : Array
        (n, m): B.
    held, inner : Array
        (n, m) and (m, m): B behind the inverse of the first term, and the inverse of 1 + B^T of that.
    """

    per_sd: Array
    own: float
    bands: Array | None
    bend: Array
    held: Array
    inner: Array

    @classmethod
    def of(cls, noise: WireNoise, neighbours: Neighbours, weight: Array, bend: Array) -> "PlaceCovariance":
        """Of places (n,) by their noise and weight."""
        own, bands = 1.0 - noise.shared, None
        if noise.shared > 0.0:
            bands = neighbours.precision() / noise.shared
            bands[1] += 1.0 / own
        per_sd = np.sqrt(weight) / noise.sd_px
        held = _without_map(per_sd, own, bands, bend)
        inner = np.linalg.inv(np.eye(bend.shape[1]) + bend.T @ held)
        return cls(per_sd, own, bands, bend, held, np.asarray(inner, dtype=np.float64))

    def solved(self, values: Array) -> Array:
        """The inverse covariance times values (n, k)."""
        first = _without_map(self.per_sd, self.own, self.bands, values)
        return np.asarray(first - self.held @ (self.inner @ (self.held.T @ values)))


def _without_map(per_sd: Array, own: float, bands: Array | None, values: Array) -> Array:
    """The inverse of S ((1 - s) 1 + s N) S times values (n, k), by Woodbury's identity."""
    alone = values * (per_sd / own)[:, None]
    if bands is not None:
        alone -= solveh_banded(bands, alone, check_finite=False) / own
    return np.asarray(alone * per_sd[:, None])
