"""The distortion map that a plate's balls show.

The targets of the balls are the lattice of the plate under the similarity that fits the raw balls best.
"""

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
    terms_by = {degree: richest[:, total <= degree] for degree in DEGREES}
    kept_by = {degree: _kept(terms, wanted) for degree, terms in terms_by.items()}
    degree = min(DEGREES, key=lambda d: _leave_one_out(terms_by[d][kept_by[d]], wanted[kept_by[d]]))
    kept = kept_by[degree]
    terms = terms_by[degree][kept]
    coefficients, inverse = _solved(terms, wanted[kept])
    residual = wanted[kept] - terms @ coefficients
    variance = float((residual**2).sum() / (2 * (len(terms) - terms.shape[1])))
    rms_px = float(np.sqrt((residual**2).sum(axis=1).mean()))
    pixel_size_mm = spacing_mm / spacing_px
    fitted = DistortionMap(centre, half_size_px, degree, coefficients, int(kept.sum()), rms_px, pixel_size_mm)
    sites = _invertible(fitted, _places_in(lattice, corrected, rows, columns))
    balls = FittedBalls(raw, corrected, fitted.corrected_from_raw(raw) - corrected, kept)
    return PlateFit(fitted, variance * inverse, sites, balls)


def _solved(terms: Array, wanted: Array) -> tuple[Array, Array]:
    """Coefficients (m, 2) of least squares, and the inverse (m, m) of the normal equations."""
    inverse = np.linalg.inv(terms.T @ terms)
    return np.asarray(inverse @ (terms.T @ wanted)), np.asarray(inverse)


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


def _kept(terms: Array, wanted: Array) -> NDArray[np.bool_]:
    """Which balls stay when those beyond 4 robust standard deviations are left out, in turns."""
    kept = np.ones(len(terms), dtype=bool)
    for _ in range(_REJECTION_ROUNDS):
        distance = np.linalg.norm(wanted - terms @ _solved(terms[kept], wanted[kept])[0], axis=1)
        # the median of a Rayleigh distribution is 1.1774 standard deviations of a coordinate
        again = distance < _OUTLIER_SD * np.median(distance[kept]) / 1.1774
        if (again == kept).all():
            break
        kept = again
    return kept


def _leave_one_out(terms: Array, wanted: Array) -> float:
    """Mean squared error of each ball predicted from all others, px^2, by the diagonal of the hat matrix."""
    coefficients, inverse = _solved(terms, wanted)
    leverage = ((terms @ inverse) * terms).sum(axis=1)
    return float(np.mean(((wanted - terms @ coefficients) / (1.0 - leverage)[:, None]) ** 2))
