"""How the places on the wires scatter: each on its own, together with its neighbours, and with the distortion map.

Bone and tissue beside a wire push a whole stretch of it to one side, so neighbours err together. How much is measured
in the residuals of the image; over which length is the ground's nature. Correlation that falls exponentially along a
wire has an inverse with three diagonals, and the map has few coefficients: no matrix of all places is ever made.
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
_ROBUST = 1.4826  # standard deviation of a Gaussian by its median absolute deviation


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

    def precision(self) -> Array:
        """Inverse of the correlation matrix: its diagonal, and the one above it after a place of no meaning; (2, n)."""
        apart = 1.0 - self.alike**2
        bands = np.ones((2, len(self.alike) + 1))
        bands[0, 1:] = -self.alike / apart
        bands[1, :-1] = 1.0 / apart
        bands[1, 1:] += self.alike**2 / apart
        return bands


@dataclass(frozen=True, slots=True)
class WireNoise:
    """Standard deviations beyond the pixels' own noise, px: of each place for itself, and common to neighbours."""

    own_px: float
    shared_px: float

    @classmethod
    def measured(cls, residual_px: Array, sd_px: Array, seen: NDArray[np.bool_], neighbours: Neighbours) -> "WireNoise":
        """From residuals (n,), the pixels' share of them (n,), and which of the places are seen (n,)."""
        typical = (_ROBUST * float(np.median(np.abs(residual_px)))) ** 2
        product = size = 0.0
        inner = np.where(seen, residual_px, 0.0)
        for apart, alike in enumerate(neighbours.pairs(), 1):
            product += float((inner[:-apart] * inner[apart:]) @ alike)
            size += float((seen[:-apart] & seen[apart:]) @ alike**2)
        shared = min(max(product / max(size, 1e-9), 0.0), typical)
        own = max(typical - shared - float(np.median(sd_px)) ** 2, LEAST_NOISE_PX**2)
        return cls(float(np.sqrt(own)), float(np.sqrt(shared)))

    def variance(self, sd_px: Array) -> Array:
        """Of each place (n,), px^2."""
        return np.asarray(sd_px**2 + self.own_px**2 + self.shared_px**2)


@dataclass(frozen=True, slots=True, eq=False)
class PlaceCovariance:
    """Covariance of all places' errors, px^2: W^-1/2 (D + s^2 N) W^-1/2 + B B^T.

    D are the places' own variances, N the correlation of the common error, W their weights, B the map's share.

    Attributes
    ----------
    root_weight : Array
        (n,): roots of W.
    own, bands : Array
        (n,) and (2, n): D, and D^-1 + (s^2 N)^-1, the diagonal below the one above it; no bands where nothing is
        shared.
    bend : Array
        (n, m): B.
    held, inner : Array
        (n, m) and (m, m): B behind the inverse of the first term, and the inverse of 1 + B^T of that.
    """

    root_weight: Array
    own: Array
    bands: Array | None
    bend: Array
    held: Array
    inner: Array

    @classmethod
    def of(
        cls, noise: WireNoise, sd_px: Array, neighbours: Neighbours, weight: Array, bend: Array
    ) -> "PlaceCovariance":
        """Of places (n,) by their noise and weight; those of little weight are taken for noisier."""
        own, bands = sd_px**2 + noise.own_px**2, None
        if noise.shared_px > 0.0:
            bands = neighbours.precision() / noise.shared_px**2
            bands[1] += 1.0 / own
        root = np.sqrt(weight)
        held = _without_map(root, own, bands, bend)
        inner = np.linalg.inv(np.eye(bend.shape[1]) + bend.T @ held)
        return cls(root, own, bands, bend, held, np.asarray(inner, dtype=np.float64))

    def solved(self, values: Array) -> Array:
        """The inverse covariance times values (n, k)."""
        first = _without_map(self.root_weight, self.own, self.bands, values)
        return np.asarray(first - self.held @ (self.inner @ (self.held.T @ values)))


def _without_map(root_weight: Array, own: Array, bands: Array | None, values: Array) -> Array:
    """The inverse of W^-1/2 (D + s^2 N) W^-1/2 times values (n, k), by Woodbury's identity."""
    alone = values * (root_weight / own)[:, None]
    if bands is not None:
        alone -= solveh_banded(bands, alone, check_finite=False) / own[:, None]
    return np.asarray(alone * root_weight[:, None])
