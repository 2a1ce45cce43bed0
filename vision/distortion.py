"""The smooth map between raw and corrected pixels, and its uncertainty.

The corrected grid keeps the raw image's place, turn and mean pixel size.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision import legendre
from vision.table import Table

Array = NDArray[np.float64]

_NEWTON_ROUNDS = 12
_SETTLED_PX = 5e-5  # of a round; the next one would move a tenth of it
_GREATEST_DEGREE = 12  # believed from a file
_INVERSE_REACH = 1.5  # half sizes of the image from its centre: where inverting is tried at all
_INVERSE_DEGREE = 11  # its own displacement makes the inverse of a map of degree 7 richer
_INVERSE_RINGS, _INVERSE_SPOKES = 12, 24  # places that the inverse is fitted to, in the round field
_INVERSE_ROUNDS = 4
_KNOWN = 1e-14  # of the greatest variance: what is left of rounding
_FOLDED = 0.05  # ratio of the singular values of the map's derivative below which it is no map any more


@dataclass(frozen=True, eq=False)  # without slots: what follows from the fields is kept
class DistortionMap:
    """Bivariate Legendre polynomial raw -> corrected, as a displacement; without terms it is the identity.

    Attributes
    ----------
    centre_px, half_size_px : float
        Raw pixel that maps to the polynomial's origin (both axes' centre), and the scale to -1 .. 1.
    coefficients : Array
        (m, 2): displacement in u and v of each term, px; order of `legendre.exponents`.
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
        return points + legendre.evaluate(self._grid, self._normalised(points))

    def corrected_window(self, left: int, top: int, columns: int, rows: int) -> Array:
        """Corrected pixels (2, rows, columns), u and v, of a window of raw pixels that begins at column `left`."""
        u, v = left + np.arange(columns, dtype=np.float64), top + np.arange(rows, dtype=np.float64)
        x, y = ((axis - middle) / self.half_size_px for axis, middle in zip((u, v), self.centre_px, strict=True))
        corrected = legendre.evaluate_on_grid(self._grid, x, y)
        corrected[0] += u
        corrected[1] += v[:, None]
        return corrected

    def raw_from_corrected(self, points: Array) -> Array:
        """Raw pixels (n, 2) of corrected pixels (n, 2): by a polynomial, then corrected by what it misses.

        Far outside the field the map's own polynomial folds: there the results stay within half an image of the border
        and mean nothing.
        """
        points = np.asarray(points, dtype=np.float64)
        if self.is_identity:
            return points.copy()
        start = self._within_reach(points)
        raw = start + legendre.evaluate(self._inverse_grid, self._normalised(start))
        # the map is so nearly the identity that each round gains a digit or two
        for _ in range(_INVERSE_ROUNDS):
            excess = self.corrected_from_raw(raw) - points
            raw = raw - np.clip(excess, -self.half_size_px, self.half_size_px)
            if np.abs(excess).max(initial=0.0) < _SETTLED_PX:
                return raw
        left = ~(np.abs(excess) < _SETTLED_PX).all(axis=1)
        raw[left] = self._inverted(points[left])
        return raw

    def _inverted(self, points: Array) -> Array:
        """Raw pixels (n, 2) by Newton's method from the corrected pixels, with the derivative there."""
        raw = self._within_reach(points)
        inverse = np.linalg.pinv(self.jacobian(raw), rcond=_FOLDED)
        for _ in range(_NEWTON_ROUNDS):
            step: Array = np.einsum("nij,nj->ni", inverse, self.corrected_from_raw(raw) - points)
            raw = self._within_reach(raw - step)
            if not np.abs(step).max(initial=0.0) > _SETTLED_PX:
                break
        return np.asarray(raw, dtype=np.float64)

    @property
    def is_identity(self) -> bool:
        """Whether nothing is bent."""
        return not self.coefficients.any()

    def jacobian(self, points: Array) -> Array:
        """Derivative (n, 2, 2) of the corrected pixel by the raw pixel, at raw pixels (n, 2)."""
        slopes = legendre.differentiate(self._grid, self._normalised(points))
        return np.asarray(np.eye(2) + slopes / self.half_size_px)

    def basis(self, points: Array) -> Array:
        """Values (n, m) of the polynomial's terms at raw pixels (n, 2)."""
        return legendre.terms(self._normalised(points), self.degree)

    def _normalised(self, points: Array) -> Array:
        return np.asarray((points - np.array(self.centre_px)) / self.half_size_px)

    def _within_reach(self, points: Array) -> Array:
        centre, reach_px = np.array(self.centre_px), _INVERSE_REACH * self.half_size_px
        return np.asarray(np.clip(points, centre - reach_px, centre + reach_px), dtype=np.float64)

    @cached_property
    def _grid(self) -> Array:
        """The displacement by powers."""
        return legendre.power_grid(self.coefficients, self.degree)

    @cached_property
    def _inverse_grid(self) -> Array:
        """Coefficients of the displacement corrected -> raw, fitted to places in the round field."""
        radius = np.sqrt((np.arange(_INVERSE_RINGS) + 0.5) / (_INVERSE_RINGS - 0.5))
        angle = np.arange(_INVERSE_SPOKES) * 2.0 * np.pi / _INVERSE_SPOKES
        places = np.column_stack((np.outer(radius, np.cos(angle)).ravel(), np.outer(radius, np.sin(angle)).ravel()))
        raw = places * self.half_size_px + self.centre_px
        corrected = self.corrected_from_raw(raw)
        terms = legendre.terms(self._normalised(corrected), _INVERSE_DEGREE)
        solved = np.linalg.solve(terms.T @ terms, terms.T @ (raw - corrected))
        return legendre.power_grid(np.asarray(solved, dtype=np.float64), _INVERSE_DEGREE)

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
            coefficients=table.numbers("coefficients_px", len(legendre.exponents(degree)), 2),
            balls=table.integer("balls", 0, 1_000_000),
            rms_px=table.number("rms_px"),
            pixel_size_mm=table.number("pixel_size_mm"),
        )


@dataclass(frozen=True, slots=True, eq=False)
class FittedBalls:
    """Balls that a map was fitted to.

    Attributes
    ----------
    raw, corrected : Array
        (n, 2) each: where they were seen, and their places on the corrected grid.
    residual_px : Array
        (n, 2): where the map takes them, from those places.
    kept : NDArray[np.bool_]
        (n,): those that the map rests on.
    """

    raw: Array
    corrected: Array
    residual_px: Array
    kept: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)  # without slots: what follows from the fields is kept
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

    @cached_property
    def coefficient_root(self) -> Array:
        """(m, k): times its transpose it is the coefficients' covariance; nothing where the map is known."""
        variances, directions = np.linalg.eigh(self.coefficient_covariance)
        seen = variances > _KNOWN * variances[-1]
        return np.asarray(directions[:, seen] * np.sqrt(variances[seen]))

    def covariance_of(self, points: Array) -> Array:
        """Covariance (n, n), px^2, of one coordinate of the corrected pixels at raw pixels (n, 2)."""
        basis = self.map.basis(points)
        return np.asarray(basis @ self.coefficient_covariance @ basis.T)


def exact(distortion: DistortionMap) -> PlateFit:
    """A map that is known, not fitted."""
    terms = len(legendre.exponents(distortion.degree))
    none = np.zeros((0, 2))
    return PlateFit(distortion, np.zeros((terms, terms)), none, FittedBalls(none, none, none, np.zeros(0, dtype=bool)))
