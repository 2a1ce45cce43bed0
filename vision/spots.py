"""Round dark spots (plate balls, the bead) located below the pixel."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_REACH = 2.0  # half side of the patch, in spot radii
_ROUNDS = 6
_WIDTH = 0.75  # of a Gaussian that is like a ball's shadow, in spot radii
_NARROWEST, _WIDEST = 0.4, 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Spots:
    """Centres in raw pixels (n, 2), peak absorption (n,), and whether the fit settled near its start (n,)."""

    raw: Array
    amplitude: Array
    settled: NDArray[np.bool_]


def fit_spots(values: NDArray[np.float32], starts: Array, radius_px: float) -> Spots:
    """Fit a Gaussian spot on a sloping ground around each start, by Gauss-Newton.

    Parameters
    ----------
    values : NDArray[np.float32]
        Absorption (rows, columns).
    starts : Array
        (n, 2), raw pixels, within a radius of the spots.
    radius_px : float
        Radius of the spots.

    Returns
    -------
    Spots
        Those too near the border are not settled.
    """
    reach = round(_REACH * radius_px)
    offsets = np.arange(-reach, reach + 1, dtype=np.intp)
    v, u = np.repeat(offsets, len(offsets)), np.tile(offsets, len(offsets))
    pixels = np.rint(starts).astype(np.intp)
    limits = np.array(values.shape[::-1]) - reach - 1
    inside: NDArray[np.bool_] = np.all((pixels >= reach + 1) & (pixels < limits), axis=1)
    corner = np.where(inside[:, None], pixels, reach + 1)
    patches = values[corner[:, 1, None] + v, corner[:, 0, None] + u].astype(np.float64)
    centres, sigma = starts - corner, np.full(len(starts), _WIDTH * radius_px)
    centres[~inside] = 0.0
    amplitude = np.zeros(len(starts))
    for _ in range(_ROUNDS):
        centres, sigma, amplitude = _step(patches, centres, sigma, u, v)
        sigma = np.clip(sigma, _NARROWEST * radius_px, _WIDEST * radius_px)
    near = np.abs(corner + centres - starts).max(axis=1) < radius_px
    return Spots(corner + centres, amplitude, inside & near & (amplitude > 0.0))


def _step(
    patches: Array, centres: Array, sigma: Array, u: NDArray[np.intp], v: NDArray[np.intp]
) -> tuple[Array, Array, Array]:
    """One step of centre and width of each patch; amplitude and ground are linear and solved beforehand."""
    x, y = u - centres[:, :1], v - centres[:, 1:]
    spot = np.exp(-(x**2 + y**2) / (2.0 * sigma[:, None] ** 2))
    ground = [np.ones_like(spot), np.broadcast_to(u, spot.shape), np.broadcast_to(v, spot.shape)]
    amplitude = solve_patches(np.stack([spot, *ground], axis=2), patches)[:, 0]
    scaled = amplitude[:, None] * spot
    slopes = [scaled * x / sigma[:, None] ** 2, scaled * y / sigma[:, None] ** 2]
    width = scaled * (x**2 + y**2) / sigma[:, None] ** 3
    steps = solve_patches(np.stack([*slopes, width, spot, *ground], axis=2), patches - scaled)
    return centres + np.clip(steps[:, :2], -1.0, 1.0), sigma + np.clip(steps[:, 2], -0.5, 0.5), amplitude


def solve_patches(design: Array, wanted: Array) -> Array:
    """Least squares for each of n patches of p pixels: design (n, p, k), wanted (n, p) -> (n, k)."""
    normal = np.einsum("npk,npl->nkl", design, design)
    # a hair of ridge: a patch without contrast has no defined centre, and must not stop the others
    normal += (1e-9 * np.trace(normal, axis1=1, axis2=2) + 1e-30)[:, None, None] * np.eye(design.shape[2])
    return np.linalg.solve(normal, np.einsum("npk,np->nk", design, wanted)[:, :, None])[:, :, 0]
