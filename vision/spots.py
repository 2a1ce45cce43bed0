"""Round dark spots (plate balls, the bead) located below the pixel."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_REACH = 2.0  # half side of the patch, in spot radii
_MOST_ROUNDS = 8
_SETTLED = 2e-3  # of a radius, the last step; the next is far smaller
_WIDTH = 0.75  # of a Gaussian that is like a ball's shadow, in spot radii
_NARROWEST, _WIDEST = 0.4, 1.5
_LONGEST_STEP = 0.4  # of centre and width, in standard deviations of the spot


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
    reach = max(2, round(_REACH * radius_px))
    offsets = np.arange(-reach, reach + 1)
    pixels = np.rint(starts).astype(np.intp)
    limits = np.array(values.shape[::-1]) - reach - 1
    inside: NDArray[np.bool_] = np.all((pixels >= reach + 1) & (pixels < limits), axis=1)
    corner = np.where(inside[:, None], pixels, reach + 1)
    pixel = (corner[:, 1, None, None] + offsets[:, None]) * values.shape[1] + corner[:, 0, None, None] + offsets
    patches = _without_ground(values.take(pixel).astype(np.float64), offsets)
    centres, sigma = np.where(inside[:, None], starts - corner, 0.0), np.full(len(starts), _WIDTH * radius_px)
    amplitude, moving = np.zeros(len(starts)), np.arange(len(starts))
    for _ in range(_MOST_ROUNDS):
        step, widening, amplitude[moving] = _step(patches[moving], centres[moving], sigma[moving], offsets)
        centres[moving] += step
        sigma[moving] = np.clip(sigma[moving] + widening, _NARROWEST * radius_px, _WIDEST * radius_px)
        moving = moving[np.abs(step).max(axis=1) > _SETTLED * radius_px]
        if not len(moving):
            break
    settled = inside & (np.abs(corner + centres - starts).max(axis=1) < radius_px) & (amplitude > 0.0)
    settled[moving] = False
    return Spots(corner + centres, amplitude, settled)


def _without_ground(patches: Array, offsets: NDArray[np.intp]) -> Array:
    """Patches (n, s, s) less their best sloping plane."""
    along = _orthonormal(offsets)
    by_terms = along.T @ patches @ along
    by_terms[:, 1, 1] = 0.0
    return np.asarray(patches - along @ by_terms @ along.T)


def _orthonormal(offsets: NDArray[np.intp]) -> Array:
    """Columns (s, 2) of unit length: one and the offsets, which are even about 0."""
    terms: Array = np.column_stack((np.ones(len(offsets)), offsets))
    return np.asarray(terms / np.sqrt((terms**2).sum(axis=0)))


def _step(patches: Array, centres: Array, sigma: Array, offsets: NDArray[np.intp]) -> tuple[Array, Array, Array]:
    """Steps of centre (n, 2) and width (n,) of each spot, and its amplitude (n,).

    A Gaussian and its derivatives are products of a function of u and one of v, so that sums over a patch are products
    of sums along u and v. The patches have no plane left, so it is taken out of the model alone.
    """
    along_u, along_v = (_moments(offsets - centres[:, axis, None], sigma) for axis in (0, 1))
    powers_u, powers_v = _POWERS.T
    gram = _at(along_u @ along_u.swapaxes(1, 2), powers_u[:, None], powers_u)
    gram *= _at(along_v @ along_v.swapaxes(1, 2), powers_v[:, None], powers_v)
    plane = _orthonormal(offsets)
    plane_u = np.tensordot(along_u, plane, 1).take(powers_u, axis=1)
    plane_v = np.tensordot(along_v, plane, 1).take(powers_v, axis=1)
    shared: Array = np.stack([plane_u[:, :, i] * plane_v[:, :, j] for i, j in ((0, 0), (1, 0), (0, 1))], axis=2)
    gram -= shared @ shared.swapaxes(1, 2)
    wanted = _at(along_v @ patches @ along_u.swapaxes(1, 2), powers_v, powers_u)
    gram = (gram.reshape(len(gram), -1) @ _PAIRS_OF_TERMS.T).reshape(-1, len(_TERMS), len(_TERMS))
    wanted = wanted @ _TERMS.T
    # a hair of ridge: a patch without contrast has no defined centre, and must not stop the others
    gram += (1e-9 * np.trace(gram, axis1=1, axis2=2) + 1e-30)[:, None, None] * np.eye(len(_TERMS))
    solved = np.linalg.solve(gram, wanted[:, :, None])[:, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.nan_to_num(solved[:, 1:] / solved[:, :1]) * sigma[:, None] ** (2, 2, 3)
    limit = _LONGEST_STEP * sigma[:, None]
    relative = np.clip(relative, -limit, limit)
    return relative[:, :2], relative[:, 2], solved[:, 0]


# Powers of the offsets along u and v by which the Gaussian is multiplied, and how they make up the spot's terms: the
# spot itself, its derivatives by u, by v and by its width.
_POWERS = np.array([(0, 0), (1, 0), (0, 1), (2, 0), (0, 2)])
_TERMS = np.array([(1.0, 0, 0, 0, 0), (0, 1, 0, 0, 0), (0, 0, 1, 0, 0), (0, 0, 0, 1, 1)])
_PAIRS_OF_TERMS = np.kron(_TERMS, _TERMS)


def _at(products: Array, row: NDArray[np.intp], column: NDArray[np.intp]) -> Array:
    """Of sums of products (n, 3, 3) those of given powers, (n, ...); so sooner than by NumPy's own indexing."""
    return np.asarray(products.reshape(len(products), -1).take(row * products.shape[2] + column, axis=1))


def _moments(x: Array, sigma: Array) -> Array:
    """A Gaussian along one axis times 1, x and x squared: (n, 3, s)."""
    crest = np.exp(-(x**2) / (2.0 * sigma[:, None] ** 2))
    return np.stack((crest, crest * x, crest * x * x), axis=1)


def solve_patches(design: Array, wanted: Array) -> Array:
    """Least squares for each of n patches of p pixels: design (n, p, k), wanted (n, p) -> (n, k)."""
    transposed = design.swapaxes(1, 2)
    normal = transposed @ design
    # a hair of ridge: a patch without contrast has no defined centre, and must not stop the others
    normal += (1e-9 * np.trace(normal, axis1=1, axis2=2) + 1e-30)[:, None, None] * np.eye(design.shape[2])
    return np.asarray(np.linalg.solve(normal, transposed @ wanted[:, :, None])[:, :, 0], dtype=np.float64)
