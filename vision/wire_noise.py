"""How the places on the wires scatter: each on its own, together with its neighbours, and with the distortion map.

Bone and tissue beside a wire push a stretch of it to one side: by how much differs from stretch to stretch, and
neighbours err together. Both are measured in the residuals of the image; over which length is the ground's nature.
Correlation that falls exponentially along a wire has an inverse with three diagonals, and the map has few coefficients:
no matrix of all places is ever made.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dpotrs, dpttrf, dpttrs

Array = NDArray[np.float64]

LEAST_NOISE_PX = 0.02  # of one place: the shadow's model is no better
SHARED_OVER = 1.5  # length in wire widths over which the common error falls to 1/e: measured in rendered scenes
_FARTHEST_PAIR = 0.1  # correlation below which two places tell nothing about the common error
_GREATEST_ALIKE = 1.0 - 1e-9  # of two places at one spot: the inverse stays finite
_MOST_SHARED = 0.95  # of the variance: some of it is each pixel's own noise
_MEDIAN_SQUARE = 0.4549  # of a Gaussian of standard deviation 1
_GREATEST_SQUARE = 22.0  # about Tukey's 4.685 standard deviations squared: what lies farther off is another thing
_USUAL_PLACES = 2.0  # how many places of the usual scatter stand beside the neighbours': some five of them differ


@dataclass(frozen=True, eq=False)  # without slots: what follows from the fields is kept
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

    @cached_property
    def pairs(self) -> list[Array]:
        """Correlations of places 1, 2, ... apart, those too small to tell anything as 0."""
        found, far = [], self.alike
        while (far > _FARTHEST_PAIR).any():
            found.append(np.where(far > _FARTHEST_PAIR, far, 0.0))
            far = far[:-1] * self.alike[len(found) :]
        return found

    def around(self, values: Array) -> Array:
        """Sums (..., n) of the others' values (..., n), by their correlation."""
        total = np.zeros(values.shape)
        for apart, alike in enumerate(self.pairs, 1):
            total[..., :-apart] += alike * values[..., apart:]
            total[..., apart:] += alike * values[..., :-apart]
        return total

    def precision(self) -> tuple[Array, Array]:
        """Inverse of the correlation matrix: its diagonal (n,) and the one beside it (n - 1,)."""
        apart = 1.0 - self.alike**2
        diagonal = np.ones(len(self.alike) + 1)
        diagonal[:-1] = 1.0 / apart
        diagonal[1:] += self.alike**2 / apart
        return diagonal, -self.alike / apart


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
        variances, places = neighbours.around(np.stack((sd_px**2, every)))
        usual = (sd_px**2 + variances) / (1.0 + places)
        usual = np.maximum(usual, LEAST_NOISE_PX**2)
        usual *= max(float(np.median(residual_px**2 / usual)) / _MEDIAN_SQUARE, 1.0)
        square = np.minimum(residual_px**2 / usual, _GREATEST_SQUARE)
        squares, places = neighbours.around(np.stack((there * square, there)))
        scatter = (_USUAL_PLACES + squares) / (_USUAL_PLACES + places)
        sd_px = np.sqrt(usual * scatter)
        return cls(sd_px, _shared(np.where(seen, residual_px / sd_px, 0.0), seen, neighbours))


def _shared(deviations: Array, seen: NDArray[np.bool_], neighbours: Neighbours) -> float:
    """Which share of the variance of deviations (n,) of spread 1 neighbours have in common."""
    product = size = 0.0
    for apart, alike in enumerate(neighbours.pairs, 1):
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
    factors : tuple of Array or None
        (n,) and (n - 1,): those of the matrix of three diagonals 1 / (1 - s) + (s N)^-1; none where nothing is shared.
    bend : Array
        (n, m): B behind the inverse of the first term.
    bend_factor : Array
        (m, m): Cholesky's of 1 + B^T times that.
    """

    per_sd: Array
    own: float
    factors: tuple[Array, Array] | None
    bend: Array
    bend_factor: Array

    @classmethod
    def of(cls, noise: WireNoise, neighbours: Neighbours, weight: Array, bend: Array) -> "PlaceCovariance":
        """Of places (n,) by their noise and weight, and B (n, m)."""
        own, factors = 1.0 - noise.shared, None
        if noise.shared > 0.0:
            diagonal, beside = neighbours.precision()
            factors = dpttrf(diagonal / noise.shared + 1.0 / own, beside / noise.shared)[:2]
        none = bend[:, :0]
        alone = cls(np.sqrt(weight) / noise.sd_px, own, factors, none, none.T @ none)
        if not bend.shape[1]:
            return alone
        seen = alone.solved(bend)
        return cls(alone.per_sd, own, factors, seen, dpotrf(np.eye(bend.shape[1]) + bend.T @ seen)[0])

    def solved(self, values: Array) -> Array:
        """The inverse covariance times values (n, k), by Woodbury's identity."""
        first = values * (self.per_sd / self.own)[:, None]
        if self.factors is not None:
            first -= dpttrs(*self.factors, first)[0] / self.own
        first *= self.per_sd[:, None]
        if self.bend.shape[1]:
            first -= self.bend @ dpotrs(self.bend_factor, self.bend.T @ values)[0]
        return first
