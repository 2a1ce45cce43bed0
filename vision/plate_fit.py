"""The distortion map that a plate's balls show.

The targets of the balls are the lattice of the plate under the similarity that fits the raw balls best.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision import legendre
from vision.distortion import DistortionMap, FittedBalls, PlateFit

Array = NDArray[np.float64]

DEGREES = (5, 6, 7)  # degree 4 leaves 0.1 to 0.5 px under the guide (docs/method.md)
_OUTLIER_SD = 4.0
_REJECTION_ROUNDS = 6
_INVERTED_WITHIN_PX = 0.1


def fit(raw: Array, lattice: Array, rows: int, columns: int, spacing_mm: float) -> PlateFit:
    """Fit the map to balls.

    Parameters
    ----------
    raw : Array
        (n, 2) balls, raw pixels.
    lattice : Array
        (n, 2) their integer places on the plate.
    rows, columns : int
        Size of the image.
    spacing_mm : float
        Distance of neighbouring balls.

    Returns
    -------
    PlateFit
        Of the degree with the least leave-one-out error, balls beyond 4 standard deviations left out.
    """
    centre = ((columns - 1) / 2.0, (rows - 1) / 2.0)
    half_size_px = max(rows, columns) / 2.0
    corrected, spacing_px = _similar(lattice, raw)
    normalised, wanted = (raw - np.array(centre)) / half_size_px, corrected - raw
    richest, total = legendre.terms(normalised, DEGREES[-1]), legendre.exponents(DEGREES[-1]).sum(axis=1)
    solved = min((_solved(degree, richest[:, total <= degree], wanted) for degree in DEGREES), key=_leave_one_out)
    residual, terms = solved.residual, solved.terms
    variance = float((residual**2).sum() / (2 * (len(terms) - terms.shape[1])))
    rms_px = float(np.sqrt((residual**2).sum(axis=1).mean()))
    pixel_size_mm = spacing_mm / spacing_px
    fitted = DistortionMap(
        centre, half_size_px, solved.degree, solved.coefficients, int(solved.kept.sum()), rms_px, pixel_size_mm
    )
    sites = _invertible(fitted, _places_in(lattice, corrected, rows, columns))
    balls = FittedBalls(raw, corrected, fitted.corrected_from_raw(raw) - corrected, solved.kept)
    return PlateFit(fitted, variance * solved.inverse, sites, balls)


@dataclass(frozen=True, slots=True, eq=False)
class _Solved:
    """A polynomial by least squares.

    Attributes
    ----------
    kept : NDArray[np.bool_]
        (n,): the balls that it rests on.
    terms, residual : Array
        (k, m) and (k, 2): its terms at those balls, and what it leaves of them, px.
    coefficients, inverse : Array
        (m, 2) and (m, m): px; inverse of the normal equations.
    """

    degree: int
    kept: NDArray[np.bool_]
    terms: Array
    residual: Array
    coefficients: Array
    inverse: Array


def _solved(degree: int, terms: Array, wanted: Array) -> _Solved:
    """Of terms (n, m) and displacements (n, 2), balls beyond 4 robust standard deviations left out, in turns."""
    solved = _solved_by(np.ones(len(terms), dtype=bool), degree, terms, wanted)
    for _ in range(_REJECTION_ROUNDS):
        distance = np.linalg.norm(wanted - terms @ solved.coefficients, axis=1)
        # the median of a Rayleigh distribution is 1.1774 standard deviations of a coordinate
        again = distance < _OUTLIER_SD * np.median(distance[solved.kept]) / 1.1774
        if (again == solved.kept).all():
            break
        solved = _solved_by(again, degree, terms, wanted)
    return solved


def _solved_by(kept: NDArray[np.bool_], degree: int, terms: Array, wanted: Array) -> _Solved:
    terms, wanted = terms[kept], wanted[kept]
    inverse = np.asarray(np.linalg.inv(terms.T @ terms))
    coefficients = np.asarray(inverse @ (terms.T @ wanted))
    return _Solved(degree, kept, terms, wanted - terms @ coefficients, coefficients, inverse)


def _invertible(distortion: DistortionMap, corrected: Array) -> Array:
    """Raw pixels (k, 2) of those corrected pixels that have one: beyond the field the polynomial may fold."""
    raw = distortion.raw_from_corrected(corrected)
    excess = distortion.corrected_from_raw(raw) - corrected
    return np.asarray(raw[np.linalg.norm(excess, axis=1) < _INVERTED_WITHIN_PX])


def _places_in(lattice: Array, corrected: Array, rows: int, columns: int) -> Array:
    """Corrected pixels (k, 2) of all the lattice's places in the image, from those of the balls found."""
    design = np.column_stack((lattice, np.ones(len(lattice))))
    corrected_from_place = np.linalg.lstsq(design, corrected, rcond=None)[0]
    low, high = lattice.min(axis=0) - 1.0, lattice.max(axis=0) + 2.0
    i, j = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]), indexing="ij")
    places = np.column_stack((i.ravel(), j.ravel(), np.ones(i.size))) @ corrected_from_place
    return np.asarray(places[((places >= 0.0) & (places < (columns, rows))).all(axis=1)])


def _similar(lattice: Array, raw: Array) -> tuple[Array, float]:
    """The lattice under the similarity (reflections allowed) nearest to the raw balls, and the spacing in px."""
    mean_lattice, mean_raw = lattice.mean(axis=0), raw.mean(axis=0)
    centred = lattice - mean_lattice
    left, singular, right = np.linalg.svd((raw - mean_raw).T @ centred)
    spacing_px = float(singular.sum() / (centred**2).sum())
    return mean_raw + spacing_px * centred @ (left @ right).T, spacing_px


def _leave_one_out(solved: _Solved) -> float:
    """Mean squared error of each ball predicted from all others, px^2, by the diagonal of the hat matrix."""
    leverage = ((solved.terms @ solved.inverse) * solved.terms).sum(axis=1)
    return float(np.mean((solved.residual / (1.0 - leverage)[:, None]) ** 2))
