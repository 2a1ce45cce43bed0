"""How the places on the wires scatter: each on its own, together with its neighbours, and with the distortion map.

Bone and tissue beside a wire push a whole stretch of it to one side, so neighbours err together. How much is measured
in the residuals of the image; over which length is the ground's nature.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

Array = NDArray[np.float64]

LEAST_NOISE_PX = 0.02  # of one place: the shadow's model is no better
SHARED_OVER = 1.5  # length in wire widths over which the common error falls to 1/e: measured in rendered scenes
_FARTHEST_PAIR = 0.1  # correlation below which two places tell nothing about the common error
_ROBUST = 1.4826  # standard deviation of a Gaussian by its median absolute deviation


@dataclass(frozen=True, slots=True)
class WireNoise:
    """Standard deviations beyond the pixels' own noise, px: of each place for itself, and common to neighbours."""

    own_px: float
    shared_px: float

    @classmethod
    def measured(cls, residual_px: Array, sd_px: Array, seen: NDArray[np.bool_], nearness: Array) -> "WireNoise":
        """From residuals (n,), the pixels' share of them (n,) and the nearness (n, n) of the places to one another."""
        typical = (_ROBUST * float(np.median(np.abs(residual_px)))) ** 2
        inner = residual_px[seen]
        share = np.triu(np.where(nearness > _FARTHEST_PAIR, nearness, 0.0)[np.ix_(seen, seen)], 1)
        shared = float(inner @ share @ inner) / max(float((share**2).sum()), 1e-9)
        shared = min(max(shared, 0.0), typical)
        own = max(typical - shared - float(np.median(sd_px)) ** 2, LEAST_NOISE_PX**2)
        return cls(float(np.sqrt(own)), float(np.sqrt(shared)))

    def variance(self, sd_px: Array) -> Array:
        """Of each place (n,), px^2."""
        return np.asarray(sd_px**2 + self.own_px**2 + self.shared_px**2)

    def covariance(self, sd_px: Array, nearness: Array) -> Array:
        """Of all places (n, n), px^2."""
        return np.asarray(self.shared_px**2 * nearness + np.diag(sd_px**2 + self.own_px**2))


def nearness(wire: NDArray[np.intp], points: Array, length_px: float) -> Array:
    """Correlation (n, n) of neighbours' common error: places (n, 2) in their order along each wire."""
    steps = np.linalg.norm(np.diff(points, axis=0, prepend=points[:1]), axis=1)
    along = np.cumsum(steps)
    same = wire[:, None] == wire[None, :]
    return np.where(same, np.exp(-np.abs(along[:, None] - along[None, :]) / length_px), 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Whitening:
    """Makes correlated places independent, of standard deviation 1: the inverse of their covariance's lower root."""

    lower: Array

    @classmethod
    def of(cls, covariance: Array) -> "Whitening":
        """For a covariance (n, n)."""
        return cls(np.asarray(np.linalg.cholesky(covariance), dtype=np.float64))

    def __call__(self, values: Array) -> Array:
        """Values (n, ...) in independent standard deviations."""
        return np.asarray(solve_triangular(self.lower, values, lower=True, check_finite=False))

    def solved(self, values: Array) -> Array:
        """The inverse covariance times values (n, ...)."""
        return np.asarray(solve_triangular(self.lower, self(values), lower=True, trans="T", check_finite=False))
