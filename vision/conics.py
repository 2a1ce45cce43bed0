"""Ellipses and conic matrices; true ring centres and the 12 fiducials from the two ellipses and the line.

A ring's centre does not project onto the centre of its ellipse: it is the pole of the vanishing line of the ring's
plane. Derivation: docs/method.md.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.devices import Guide
from vision.projection import Intrinsics
from vision.refusal import Refusal, RefusalCode

Array = NDArray[np.float64]

_THINNEST_AXIS_RATIO = 1e-3  # minor to major: thinner ones are lines that an ellipse happens to fit
_CENTRE_ROUNDS = 4  # the iteration has converged far below a thousandth of a pixel by then


@dataclass(frozen=True, slots=True)
class Ellipse:
    """An ellipse in corrected pixels; `angle_rad` turns u towards v up to the major axis, in (-pi/2, pi/2]."""

    centre_px: tuple[float, float]
    semi_axes_px: tuple[float, float]
    angle_rad: float


@dataclass(frozen=True, slots=True)
class RingPair:
    """The ellipses of the two rings' wire centre lines, corrected pixels."""

    small: Ellipse
    big: Ellipse


@dataclass(frozen=True, slots=True, eq=False)
class RingCentres:
    """Projections of the true ring centres.

    Attributes
    ----------
    small_px, big_px : Array
        (2,) each, corrected pixels.
    vanishing_line : Array
        (3,), homogeneous, corrected pixels: of the planes of both rings.
    depth_ratio : float
        Z_P / Z_Q, big ring's depth over small ring's, below 1.
    """

    small_px: Array
    big_px: Array
    vanishing_line: Array
    depth_ratio: float


def fit_ellipse(points: Array) -> Ellipse | None:
    """Ellipse of least algebraic distance.

    Parameters
    ----------
    points : Array
        (n, 2), corrected pixels, n of at least 6.

    Returns
    -------
    Ellipse or None
        None where no ellipse fits the points.

    Notes
    -----
    Direct fit of Fitzgibbon in the stable form of Halir and Flusser; points are centred and scaled first, else the
    squares of pixel coordinates swamp the constant term.
    """
    mean = points.mean(axis=0)
    scale = float(np.sqrt(((points - mean) ** 2).mean()))
    if len(points) < 6 or not scale > 0.0:
        return None
    x, y = ((points - mean) / scale).T
    terms = np.stack((x * x, x * y, y * y, x, y, np.ones_like(x)))
    moments = terms @ terms.T
    quadratic, mixed, linear = moments[:3, :3], moments[:3, 3:], moments[3:, 3:]
    if not np.linalg.det(linear / len(points)) > _THINNEST_AXIS_RATIO**2:
        return None
    linear_from_quadratic = -np.linalg.solve(linear, mixed.T)
    scatter = quadratic + mixed @ linear_from_quadratic
    constrained = np.array([scatter[2] / 2.0, -scatter[1], scatter[0] / 2.0])
    values, vectors = np.linalg.eig(constrained)
    candidates = np.real(vectors[:, np.isreal(values)])
    elliptic = candidates[:, 4.0 * candidates[0] * candidates[2] > candidates[1] ** 2]
    if elliptic.shape[1] != 1:
        return None
    a, b, c = elliptic[:, 0]
    d, e, f = linear_from_quadratic @ elliptic[:, 0]
    normalised = np.array([[a, b / 2.0, d / 2.0], [b / 2.0, c, e / 2.0], [d / 2.0, e / 2.0, f]])
    shift = np.array([[1.0, 0.0, -mean[0]], [0.0, 1.0, -mean[1]], [0.0, 0.0, scale]]) / scale
    ellipse = ellipse_from_conic(shift.T @ normalised @ shift)
    if ellipse is None or ellipse.semi_axes_px[1] < _THINNEST_AXIS_RATIO * ellipse.semi_axes_px[0]:
        return None
    return ellipse


def conic_from_ellipse(ellipse: Ellipse) -> Array:
    """Symmetric (3, 3) conic of an ellipse, corrected pixels, negative inside."""
    cosine, sine = math.cos(ellipse.angle_rad), math.sin(ellipse.angle_rad)
    (u, v), (along, across) = ellipse.centre_px, (axis_px**-2 for axis_px in ellipse.semi_axes_px)
    a, c = cosine**2 * along + sine**2 * across, sine**2 * along + cosine**2 * across
    b = cosine * sine * (along - across)
    d, e = -(a * u + b * v), -(b * u + c * v)
    return np.array([[a, b, d], [b, c, e], [d, e, -(d * u + e * v) - 1.0]])


def ellipse_from_conic(conic: Array) -> Ellipse | None:
    """The ellipse of a symmetric (3, 3) conic of either sign; None where the conic is no real ellipse."""
    (a, b, d), (_, c, e), (_, _, f) = (conic * np.sign(conic[0, 0] + conic[1, 1])).tolist()
    determinant, mean, spread = a * c - b * b, (a + c) / 2.0, math.hypot((a - c) / 2.0, b)
    if not determinant > 0.0:
        return None
    u, v = (b * e - c * d) / determinant, (b * d - a * e) / determinant
    at_centre = f + d * u + e * v
    if not at_centre < 0.0:
        return None
    minor_px = math.sqrt(-at_centre / (mean + spread))
    major_px = math.sqrt(-at_centre * (mean + spread) / determinant)
    # no negative zero: it would turn an upright axis to the other end of the range
    angle_rad = math.atan2(0.0 - 2.0 * b, c - a) / 2.0
    return Ellipse((u, v), (major_px, minor_px), angle_rad)


def polar(conic: Array, point: Array) -> Array:
    """Homogeneous line (3,), polar of the homogeneous `point` (3,) with respect to the (3, 3) `conic`."""
    return np.asarray(conic @ point)


def depth_ratio(rings: RingPair, guide: Guide) -> float:
    """Z_P / Z_Q from the semi-major axes: eq. (10), with the fraction the right way up (docs/method.md)."""
    return (guide.big_ring_radius_mm * rings.small.semi_axes_px[0]) / (
        guide.small_ring_radius_mm * rings.big.semi_axes_px[0]
    )


def true_centres(rings: RingPair, guide: Guide, nominal: Intrinsics) -> RingCentres | Refusal:
    """Projections of the ring centres.

    Parameters
    ----------
    rings : RingPair
        Fitted ellipses, corrected pixels.
    guide : Guide
        Radii, mm.
    nominal : Intrinsics
        Corrected pixels; tens of pixels off change the centres by little.

    Returns
    -------
    RingCentres or Refusal
        `guide_mismatch` where the ellipses are no image of two coaxial rings.

    Notes
    -----
    Iteration of docs/method.md in coordinates normalised by K, where the vanishing line of the rings' planes is the
    axis itself. It is stable at every view, the aligned one included.
    """
    matrix = nominal.matrix()
    conics = np.stack([matrix.T @ conic_from_ellipse(ellipse) @ matrix for ellipse in (rings.small, rings.big)])
    duals = np.linalg.inv(conics)
    (q, p), ratio = _normalised(rings, nominal), depth_ratio(rings, guide)
    for _ in range(_CENTRE_ROUNDS):
        axis = q - ratio * p
        poles = duals @ axis
        q, p = poles / poles[:, 2:]
        small, big = _half_chords(conics, poles, axis)
        # a pole outside its ellipse has no chord: infinite, and refused below
        ratio = (guide.big_ring_radius_mm * small) / (guide.small_ring_radius_mm * big) if big > 0.0 else math.inf
        if not (math.isfinite(ratio) and ratio < 1.0):
            message = "the two ellipses are no image of the guide's rings: depth ratio of big to small ring"
            return Refusal(RefusalCode.GUIDE_MISMATCH, message, ratio, 1.0)
    line = np.asarray(np.linalg.solve(matrix.T, q - ratio * p), dtype=np.float64)
    return RingCentres((matrix @ q)[:2], (matrix @ p)[:2], line, ratio)


def _normalised(rings: RingPair, nominal: Intrinsics) -> Array:
    """Centres (2, 3) of the ellipses of the small and of the big ring, homogeneous, in coordinates normalised by K."""
    centres = np.ones((2, 3))
    centres[:, :2] = np.array((rings.small.centre_px, rings.big.centre_px)) - (nominal.u0_px, nominal.v0_px)
    centres[:, :2] /= nominal.alpha_x_px, nominal.alpha_y_px
    return centres


def _half_chords(conics: Array, poles: Array, vanishing_line: Array) -> list[float]:
    """Half the chord of each conic (2, 3, 3) through the pole (2, 3) of a line and parallel to it: radius over depth.

    A direction d of the line l and its pole p = C^-1 l are conjugate, so that the chord is even about the pole.
    """
    u, v, _ = vanishing_line.tolist()
    length = math.hypot(u, v)
    # seen along the axis every direction serves
    direction = np.array([v / length, -u / length, 0.0] if length > 1e-12 else [1.0, 0.0, 0.0])
    inside = -(poles @ vanishing_line) / (poles[:, 2] ** 2 * (conics @ direction @ direction))
    return [math.sqrt(max(0.0, square)) for square in inside.tolist()]


def fiducials(
    rings: RingPair, line_start_px: Array, line_end_px: Array, guide: Guide, nominal: Intrinsics
) -> dict[str, Array] | Refusal:
    """The 12 fiducials.

    Parameters
    ----------
    rings : RingPair
        Fitted ellipses, corrected pixels.
    line_start_px, line_end_px : Array
        (2,) each, ends of the indicator line, corrected pixels.
    guide, nominal
        As for `true_centres`.

    Returns
    -------
    dict or Refusal
        (2,) each, corrected pixels, by the names of `projection.fiducials_in_guide`.
    """
    centres = true_centres(rings, guide, nominal)
    if isinstance(centres, Refusal):
        return centres
    line = np.cross((*line_start_px, 1.0), (*line_end_px, 1.0))
    vanishing_x = _vanishing_x(line, line_start_px, line_end_px, centres)
    points: dict[str, Array] = {}
    for name, ellipse, centre in (("small", rings.small, centres.small_px), ("big", rings.big, centres.big_px)):
        points |= _ring_fiducials(name, conic_from_ellipse(ellipse), centre, vanishing_x)
    return points | {"line_start": np.array(line_start_px), "line_end": np.array(line_end_px)}


def _vanishing_x(line: Array, start_px: Array, end_px: Array, centres: RingCentres) -> Array:
    """Vanishing point (3,) of guide x, signed so that x - x_3 * point leads towards guide +x at every image point."""
    point = np.cross(line, centres.vanishing_line)
    point /= np.linalg.norm(point)
    return np.asarray(np.copysign(1.0, (point[:2] - point[2] * start_px) @ (end_px - start_px)) * point)


def _ring_fiducials(name: str, conic: Array, centre: Array, vanishing_x: Array) -> dict[str, Array]:
    """Centre and the ends of the diameters along guide x and y; y+ is a quarter turn from x+, from u towards v."""
    along_x = vanishing_x[:2] - vanishing_x[2] * centre
    y_line = polar(conic, vanishing_x)
    along_y = np.array([-y_line[1], y_line[0]])
    along_y *= np.copysign(1.0, along_x[0] * along_y[1] - along_x[1] * along_y[0])
    points = {f"{name}_centre": centre}
    for axis, direction in (("x", along_x), ("y", along_y)):
        minus, plus = _chord_ends(conic, centre, direction / np.linalg.norm(direction))
        points |= {f"{name}_{axis}_plus": plus, f"{name}_{axis}_minus": minus}
    return points


def _chord_ends(conic: Array, centre: Array, direction: Array) -> tuple[Array, Array]:
    """Ends (2,) of the chord through `centre`, against and along the unit `direction` (2,)."""
    minus, plus = _chord(conic, np.array([*centre, 1.0]), np.array([*direction, 0.0]))
    return centre + direction * minus, centre + direction * plus


def _chord(conic: Array, point: Array, direction: Array) -> tuple[float, float]:
    """Distances from `point` (3,) along `direction` (3,) at which the conic is met; the same twice where it is not."""
    a, b, c = (
        float(value) for value in (direction @ conic @ direction, direction @ conic @ point, point @ conic @ point)
    )
    root = math.sqrt(max(0.0, b * b - a * c))
    return (-b - root) / a, (-b + root) / a
