"""Bivariate Legendre polynomials of limited total degree: they stay well conditioned where powers do not."""

from functools import cache

import numpy as np
from numpy.polynomial.legendre import leg2poly
from numpy.typing import NDArray

Array = NDArray[np.float64]

_AT_ONCE = 1 << 11  # points evaluated together: what a processor keeps near it


def exponents(degree: int) -> NDArray[np.intp]:
    """Degrees in x and y (m, 2) of the terms of total degree up to `degree`, in the order of their coefficients."""
    return np.array([(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)], dtype=np.intp)


def terms(points: Array, degree: int) -> Array:
    """Values (n, m) of the terms at points (n, 2) of the square -1 .. 1."""
    x, y = _ladders(points, degree)
    i, j = exponents(degree).T
    return np.asarray((x[i] * y[j]).T)


def evaluate(grid: Array, points: Array) -> Array:
    """Values (n, k) at points (n, 2) of k polynomials with a `power_grid` (k, d + 1, d + 1)."""
    values = np.empty((len(points), len(grid)))
    for start in range(0, len(points), _AT_ONCE):
        x, y = _powers(points[start : start + _AT_ONCE], grid.shape[1] - 1)
        along_y = (grid.reshape(-1, grid.shape[2]) @ y).reshape(*grid.shape[:2], -1)
        values[start : start + _AT_ONCE] = np.einsum("kin,in->kn", along_y, x).T
    return values


def evaluate_on_grid(grid: Array, x: Array, y: Array) -> Array:
    """The polynomials of `evaluate` (k, rows, columns) at every x (columns,) with every y (rows,)."""
    along_x, along_y = (np.vander(axis, grid.shape[1], increasing=True) for axis in (x, y))
    return np.asarray((along_y @ grid.transpose(0, 2, 1)) @ along_x.T)


def differentiate(grid: Array, points: Array) -> Array:
    """Derivatives (n, k, 2) by x and y of the polynomials of `evaluate`."""
    x, y = _powers(points, grid.shape[1] - 1)
    by_x, by_y = ((grid @ y) * _slopes(x)).sum(axis=1), ((grid @ _slopes(y)) * x).sum(axis=1)
    return np.stack((by_x.T, by_y.T), axis=2)


def power_grid(coefficients: Array, degree: int) -> Array:
    """Polynomials with coefficients (m, k) in the order of `exponents`, by powers of x and y: (k, d + 1, d + 1).

    Powers take a third of the time, and at these degrees cost a few digits of sixteen; fits need Legendre's terms.
    """
    grid = np.zeros((coefficients.shape[1], degree + 1, degree + 1))
    i, j = exponents(degree).T
    grid[:, i, j] = coefficients.T
    powers = _in_powers(degree)
    return np.asarray(powers.T @ grid @ powers)


@cache
def _in_powers(degree: int) -> Array:
    """Coefficients (d + 1, d + 1) of each Legendre polynomial by powers."""
    powers = np.zeros((degree + 1, degree + 1))
    for order, one in enumerate(np.eye(degree + 1)):
        powers[order, : order + 1] = leg2poly(one[: order + 1])
    powers.flags.writeable = False
    return powers


def _ladders(points: Array, degree: int) -> tuple[Array, Array]:
    """Legendre polynomials (d + 1, n) of degrees 0 to d of each coordinate of points (n, 2), by Bonnet's recursion."""
    both = np.ascontiguousarray(points.T)
    ladder = np.ones((degree + 1, *both.shape))
    if degree:
        ladder[1] = both
    for k in range(1, degree):
        np.multiply(both, ladder[k], out=ladder[k + 1])
        ladder[k + 1] *= (2 * k + 1) / (k + 1)
        ladder[k + 1] -= (k / (k + 1)) * ladder[k - 1]
    return np.ascontiguousarray(ladder[:, 0]), np.ascontiguousarray(ladder[:, 1])


def _powers(points: Array, degree: int) -> tuple[Array, Array]:
    """Powers (d + 1, n) from 0 to d of each coordinate of points (n, 2)."""
    both = np.ascontiguousarray(points.T)
    powers = np.empty((2, degree + 1, both.shape[1]))
    powers[:, 0] = 1.0
    for k in range(degree):
        np.multiply(powers[:, k], both, out=powers[:, k + 1])
    return powers[0], powers[1]


def _slopes(powers: Array) -> Array:
    """Derivatives (d + 1, n) of powers."""
    slopes = np.zeros_like(powers)
    slopes[1:] = powers[:-1] * np.arange(1, len(powers))[:, None]
    return slopes
