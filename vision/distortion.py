"""The smooth map between raw and corrected pixels, fitted to the plate's balls.

The corrected grid keeps the raw image's place, turn and mean pixel size: its targets are the lattice of the plate under
the similarity that fits the raw balls best.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from vision.table import Table

Array = NDArray[np.float64]

DEGREES = (5, 6, 7)  # degree 4 leaves 0.1 to 0.5 px under the guide (docs/method.md)
_NEWTON_ROUNDS = 12
_SETTLED_PX = 1e-7  # of a round; the next one would move a thousandth of it
_OUTLIER_SD = 4.0
_REJECTION_ROUNDS = 6
_GREATEST_DEGREE = 12  # believed from a file
_INVERTED_WITHIN_PX = 0.1
_INVERSE_REACH = 1.5  # half sizes of the image from its centre: where inverting is tried at all
_FOLDED = 0.05  # ratio of the singular values of the map's derivative below which it is no map any more
_STEP_PX = 0.5  # of the map's numerical derivative; the map bends over hundreds of pixels


@dataclass(frozen=True, slots=True, eq=False)
class DistortionMap:
    """Bivariate Legendre polynomial raw -> corrected, as a displacement; without terms it is the identity.

    Attributes
    ----------
    centre_px, half_size_px : float
        Raw pixel that maps to the polynomial's origin (both axes' centre), and the scale to -1 .. 1.
    coefficients : Array
        (m, 2): displacement in u and v of each term, px; order of `_terms`.
    balls : int
        Balls that the fit rests on; 0 for a flat panel.
    rms_px : float
        Root mean square distance of those balls from the map, px.
    pixel_size_mm : float
        Size of a corrected pixel at the detector.
    """

    centre_px: tuple[float, float]
    half_size_px: float
    degree: int
    coefficients: Array
    balls: int
    rms_px: float
    pixel_size_mm: float

    @classmethod
    def identity(cls, rows: int, columns: int, pixel_size_mm: float) -> "DistortionMap":
        """The map of a detector that does not distort."""
        centre = ((columns - 1) / 2.0, (rows - 1) / 2.0)
        return cls(centre, max(rows, columns) / 2.0, 0, np.zeros((1, 2)), 0, 0.0, pixel_size_mm)

    def corrected_from_raw(self, points: Array) -> Array:
        """Corrected pixels (n, 2) of raw pixels (n, 2)."""
        points = np.asarray(points, dtype=np.float64)
        return points + self.basis(points) @ self.coefficients

    def raw_from_corrected(self, points: Array) -> Array:
        """Raw pixels (n, 2) of corrected pixels (n, 2), by Newton's method with the derivative at the start.

        The map bends so little over its own displacement that each round gains three digits. Far outside the field
        the polynomial folds: there the results stay within half an image of the border and mean nothing.
        """
        points = np.asarray(points, dtype=np.float64)
        if not self.coefficients.any():
            return points.copy()
        centre, reach_px = np.array(self.centre_px), _INVERSE_REACH * self.half_size_px
        raw = np.clip(points, centre - reach_px, centre + reach_px)
        inverse = np.linalg.pinv(self.jacobian(raw), rcond=_FOLDED)
        for _ in range(_NEWTON_ROUNDS):
            step = np.einsum("nij,nj->ni", inverse, self.corrected_from_raw(raw) - points)
            raw = np.clip(raw - step, centre - reach_px, centre + reach_px)
            if not np.abs(step).max(initial=0.0) > _SETTLED_PX:
                break
        return raw

    def jacobian(self, points: Array) -> Array:
        """Derivative (n, 2, 2) of the corrected pixel by the raw pixel, at raw pixels (n, 2)."""
        columns = []
        for step in np.eye(2) * _STEP_PX:
            ahead, behind = self.corrected_from_raw(points + step), self.corrected_from_raw(points - step)
            columns.append((ahead - behind) / (2.0 * _STEP_PX))
        return np.stack(columns, axis=2)

    def basis(self, points: Array) -> Array:
        """Values (n, m) of the polynomial's terms at raw pixels (n, 2)."""
        return _terms((points - np.array(self.centre_px)) / self.half_size_px, self.degree)

    def to_json(self) -> dict[str, Any]:
        """All that mapping raw to corrected pixels needs, with the balls used and their rms."""
        return {
            "balls": self.balls,
            "rms_px": self.rms_px,
            "pixel_size_mm": self.pixel_size_mm,
            "centre_px": list(self.centre_px),
            "half_size_px": self.half_size_px,
            "degree": self.degree,
            "coefficients_px": self.coefficients.tolist(),
        }

    @classmethod
    def from_json(cls, data: Any) -> "DistortionMap":
        """The map in a JSON object; ValueError with one line where it is none."""
        table = Table.of(data, "distortion")
        degree = table.integer("degree", 0, _GREATEST_DEGREE)
        centre, half_size_px = table.numbers("centre_px", 2), table.number("half_size_px")
        if not half_size_px > 0.0 or not table.number("pixel_size_mm") > 0.0 or table.number("rms_px") < 0.0:
            raise ValueError("distortion: half_size_px and pixel_size_mm must be positive, rms_px not negative")
        return cls(
            centre_px=(float(centre[0]), float(centre[1])),
            half_size_px=half_size_px,
            degree=degree,
            coefficients=table.numbers("coefficients_px", _term_count(degree), 2),
            balls=table.integer("balls", 0, 1_000_000),
            rms_px=table.number("rms_px"),
            pixel_size_mm=table.number("pixel_size_mm"),
        )


@dataclass(frozen=True, slots=True, eq=False)
class FittedBalls:
    """Balls that a map was fitted to: raw (n, 2), their places on the corrected grid (n, 2), which were kept (n,)."""

    raw: Array
    corrected: Array
    kept: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class PlateFit:
    """A map, its uncertainty, and where the plate has balls.

    Attributes
    ----------
    coefficient_covariance : Array
        (m, m), px^2, the same for u and v.
    sites : Array
        (k, 2), raw pixels of all places of the lattice in the image, balls seen or not.
    balls : FittedBalls
        Those seen.
    """

    map: DistortionMap
    coefficient_covariance: Array
    sites: Array
    balls: FittedBalls

    def covariance_of(self, points: Array) -> Array:
        """Covariance (n, n), px^2, of one coordinate of the corrected pixels at raw pixels (n, 2)."""
        basis = self.map.basis(points)
        return np.asarray(basis @ self.coefficient_covariance @ basis.T)


def exact(distortion: DistortionMap) -> PlateFit:
    """A map that is known, not fitted."""
    terms = _term_count(distortion.degree)
    none = np.zeros((0, 2))
    return PlateFit(distortion, np.zeros((terms, terms)), none, FittedBalls(none, none, np.zeros(0, dtype=bool)))


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
    normalised = (raw - np.array(centre)) / half_size_px
    kept_by = {degree: _kept(_terms(normalised, degree), corrected - raw) for degree in DEGREES}
    degree = min(
        kept_by, key=lambda d: _leave_one_out(_terms(normalised, d)[kept_by[d]], (corrected - raw)[kept_by[d]])
    )
    kept = kept_by[degree]
    terms, wanted = _terms(normalised[kept], degree), (corrected - raw)[kept]
    coefficients = np.asarray(np.linalg.lstsq(terms, wanted, rcond=None)[0], dtype=np.float64)
    residual = wanted - terms @ coefficients
    variance = float((residual**2).sum() / (2 * (len(terms) - terms.shape[1])))
    rms_px = float(np.sqrt((residual**2).sum(axis=1).mean()))
    pixel_size_mm = spacing_mm / spacing_px
    fitted = DistortionMap(centre, half_size_px, degree, coefficients, int(kept.sum()), rms_px, pixel_size_mm)
    sites = _invertible(fitted, _places_in(lattice, corrected, rows, columns))
    covariance = np.asarray(variance * np.linalg.inv(terms.T @ terms), dtype=np.float64)
    return PlateFit(fitted, covariance, sites, FittedBalls(raw, corrected, kept))


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
        coefficients = np.linalg.lstsq(terms[kept], wanted[kept], rcond=None)[0]
        distance = np.linalg.norm(wanted - terms @ coefficients, axis=1)
        # the median of a Rayleigh distribution is 1.1774 standard deviations of a coordinate
        again = distance < _OUTLIER_SD * np.median(distance[kept]) / 1.1774
        if (again == kept).all():
            break
        kept = again
    return kept


def _leave_one_out(terms: Array, wanted: Array) -> float:
    """Mean squared error of each ball predicted from all others, px^2."""
    orthonormal, _ = np.linalg.qr(terms)
    leverage = (orthonormal**2).sum(axis=1)
    residual = wanted - orthonormal @ (orthonormal.T @ wanted)
    return float(np.mean((residual / (1.0 - leverage)[:, None]) ** 2))


def _terms(normalised: Array, degree: int) -> Array:
    """Legendre products (n, m) of total degree up to `degree`; they stay well conditioned where powers do not."""
    x, y = (legendre.legvander(normalised[:, axis], degree) for axis in (0, 1))
    return np.column_stack([x[:, i] * y[:, j] for i in range(degree + 1) for j in range(degree + 1 - i)])


def _term_count(degree: int) -> int:
    return (degree + 1) * (degree + 2) // 2
