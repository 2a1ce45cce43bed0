"""The two rings among whatever else the image shows: ellipses voted for by oriented ridge points.

Three points with tangents fix an ellipse, so few random triples suffice even where rings are broken and clutter is
common; only what then finds ridge points all around is kept.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from vision.conics import Ellipse, conic_from_ellipse, fit_ellipse
from vision.wires import Ridge

Array = NDArray[np.float64]

LEAST_SUPPORT = 0.4  # of a circumference with ridge points; what is really seen is measured and judged later (gates)
QUICK_TRIPLES = 60_000  # enough for rings as conspicuous as they mostly are
THOROUGH_TRIPLES = 300_000  # a faint ring among 5,000 ridge points still gets tens of triples of its own
_SAMPLES = 40  # on the circumference, for the first look
_FINE_SAMPLES = 180
_LOOSE_PX, _TIGHT_PX = 3.0, 1.5
_NORMALS_WITHIN = 0.95  # cosine of the angle between the ridge's normal and the ellipse's
_REFINED = 150  # hypotheses refined, the best supported first
_ALIKE_PX = 2.0  # the same of hypotheses: each refines to the same ring
_SAME_PX = 6.0  # ellipses nearer than this to one another in centre and axes are one
_MARGIN_PX = 8  # around all ridge points; beyond it the nearest is too far anyway
_SEED = 20  # of the triples: the same image gives the same registration


@dataclass(frozen=True, slots=True)
class AxisRange:
    """Plausible semi-major axes of a ring, px, and the least ratio of the axes."""

    least_px: float
    greatest_px: float
    least_ratio: float = math.cos(math.radians(52.0))  # 45 deg of tilt and the perspective's share


@dataclass(frozen=True, slots=True)
class RingCandidate:
    """An ellipse, corrected pixels, and the share of its circumference on which ridge points lie."""

    ellipse: Ellipse
    support: float


class _NearestRidge:
    """Which ridge point is nearest, looked up pixel by pixel: millions of places are asked for."""

    def __init__(self, ridge: Ridge) -> None:
        self._corner = np.floor(ridge.points.min(axis=0)).astype(np.intp) - _MARGIN_PX
        pixels = np.rint(ridge.points).astype(np.intp) - self._corner
        self._last = pixels.max(axis=0) + _MARGIN_PX
        owner = np.full((self._last[1] + 1, self._last[0] + 1), -1, dtype=np.intp)
        owner[pixels[:, 1], pixels[:, 0]] = np.arange(len(pixels))
        v, u = distance_transform_edt(owner < 0, return_distances=False, return_indices=True)
        self._index = owner[v, u]

    def index(self, points: Array) -> NDArray[np.intp]:
        """Index (...) of the ridge point nearest to each place (..., 2), corrected pixels."""
        u, v = np.moveaxis(np.clip(np.rint(points).astype(np.intp) - self._corner, 0, self._last), -1, 0)
        return np.asarray(self._index[v, u], dtype=np.intp)


def ring_candidates(ridge: Ridge, axes: AxisRange, triples: int = THOROUGH_TRIPLES) -> list[RingCandidate]:
    """Ellipses that ridge points follow.

    Parameters
    ----------
    ridge : Ridge
        Corrected pixels.
    axes : AxisRange
        What a ring may look like.
    triples : int
        How many ellipses to try.

    Returns
    -------
    list[RingCandidate]
        Best supported first, each at least `LEAST_SUPPORT`, no two of them the same.
    """
    if len(ridge.points) < 50:
        return []
    nearest = _NearestRidge(ridge)
    hypotheses = _hypotheses(ridge, axes, triples)
    support = _supports(hypotheses, ridge, nearest, _SAMPLES, _LOOSE_PX)
    candidates = [_refined(one, ridge, nearest, axes) for one in _different(hypotheses[np.argsort(-support)])]
    distinct: list[RingCandidate] = []
    for candidate in sorted((c for c in candidates if c is not None), key=lambda c: -c.support):
        if candidate.support >= LEAST_SUPPORT and not any(_same(candidate.ellipse, d.ellipse) for d in distinct):
            distinct.append(candidate)
    return distinct


def _hypotheses(ridge: Ridge, axes: AxisRange, triples: int) -> Array:
    """Ellipses (h, 5) as centre u, v and A, B, C of A x^2 + B x y + C y^2 = 1, from random triples."""
    random = np.random.default_rng(_SEED)
    triple = random.integers(0, len(ridge.points), (triples, 3))
    reach = 2.0 * axes.greatest_px
    u, v = ridge.points[:, 0][triple], ridge.points[:, 1][triple]
    near = np.ones(triples, dtype=bool)
    for other in (1, 2):
        near &= (np.abs(u[:, other] - u[:, 0]) < reach) & (np.abs(v[:, other] - v[:, 0]) < reach)
    p, n = ridge.points[triple[near]], ridge.normals[triple[near]]
    centre = _centres(p, n)
    x, y = np.moveaxis(p - centre[:, None, :], 2, 0)
    squares = np.stack((x * x, x * y, y * y), axis=2)
    solvable = np.isfinite(centre).all(axis=1) & (np.abs(np.linalg.det(np.nan_to_num(squares))) > 1.0)
    form = np.linalg.solve(squares[solvable], np.ones((int(solvable.sum()), 3, 1)))[:, :, 0]
    tangent = _follows(form, x[solvable], y[solvable], n[solvable])
    return _plausible(np.column_stack((centre[solvable], form))[tangent], axes)


def _follows(form: Array, x: Array, y: Array, normals: Array) -> NDArray[np.bool_]:
    """Which forms (h, 3) have, at all three of their points (h, 3) about the centre, the ridge's own directions."""
    a, b, c = (column[:, None] for column in form.T)
    gradient = np.stack((2.0 * a * x + b * y, b * x + 2.0 * c * y), axis=2)
    cosine = np.abs((gradient * normals).sum(axis=2)) / np.linalg.norm(gradient, axis=2)
    return np.asarray((cosine > _NORMALS_WITHIN).all(axis=1))


def _different(hypotheses: Array) -> Array:
    """The first of hypotheses (h, 5), best first, leaving out those like an earlier one.

    A conspicuous circle (the guide's housing seen end-on) is voted for by hundreds of triples, which would crowd out
    the guide's own rings.
    """
    left = np.vstack((hypotheses[:, :2].T, *_axes(hypotheses)))
    chosen: list[int] = []
    free = np.ones(len(hypotheses), dtype=bool)
    while free.any() and len(chosen) < _REFINED:
        first = int(np.argmax(free))
        chosen.append(first)
        free &= np.abs(left - left[:, first, None]).max(axis=0) > _ALIKE_PX
    return hypotheses[chosen]


def _axes(hypotheses: Array) -> tuple[Array, Array]:
    """Semi-axes (h,), major and minor; not finite where it is no ellipse."""
    _, _, a, b, c = hypotheses.T
    mean, spread = (a + c) / 2.0, np.sqrt((a - c) ** 2 / 4.0 + b**2 / 4.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return 1.0 / np.sqrt(mean - spread), 1.0 / np.sqrt(mean + spread)


def _centres(p: Array, n: Array) -> Array:
    """Centres (h, 2): the line from where two tangents meet through the middle of their points passes the centre."""
    lines = []
    for first, second in ((0, 1), (1, 2)):
        a, b = n[:, first], n[:, second]
        right = np.stack(((a * p[:, first]).sum(axis=1), (b * p[:, second]).sum(axis=1)), axis=1)
        determinant = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            meet_u = (right[:, 0] * b[:, 1] - right[:, 1] * a[:, 1]) / determinant
            meet_v = (a[:, 0] * right[:, 1] - b[:, 0] * right[:, 0]) / determinant
        middle = (p[:, first] + p[:, second]) / 2.0
        along = middle - np.stack((meet_u, meet_v), axis=1)
        lines.append((np.stack((-along[:, 1], along[:, 0]), axis=1), middle))
    (a, p_a), (b, p_b) = lines
    # parallel tangents meet nowhere: such triples are left out by their centre
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        right = np.stack(((a * p_a).sum(axis=1), (b * p_b).sum(axis=1)), axis=1)
        determinant = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        u = (right[:, 0] * b[:, 1] - right[:, 1] * a[:, 1]) / determinant
        v = (a[:, 0] * right[:, 1] - b[:, 0] * right[:, 0]) / determinant
    return np.stack((u, v), axis=1)


def _plausible(hypotheses: Array, axes: AxisRange) -> Array:
    """Those whose axes are a ring's."""
    major, minor = _axes(hypotheses)
    fits = (major > axes.least_px) & (major < axes.greatest_px) & (minor > axes.least_ratio * major)
    return np.asarray(hypotheses[fits], dtype=np.float64)


def _supports(hypotheses: Array, ridge: Ridge, nearest: _NearestRidge, samples: int, within_px: float) -> Array:
    """Share (h,) of `samples` points of each circumference near which a ridge point of the same direction lies."""
    if not len(hypotheses):
        return np.zeros(0)
    angle = np.linspace(0.0, 2.0 * np.pi, samples, endpoint=False)
    x, y = np.cos(angle), np.sin(angle)
    _, _, a, b, c = (column[:, None] for column in hypotheses.T)
    radius = 1.0 / np.sqrt(a * x * x + b * x * y + c * y * y)
    normal = np.stack((2.0 * a * x + b * y, b * x + 2.0 * c * y), axis=2)
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    points = hypotheses[:, None, :2] + radius[:, :, None] * np.stack((x, y), axis=1)
    index = nearest.index(points)
    found = np.linalg.norm(points - ridge.points[index], axis=2) < within_px
    parallel = np.abs((ridge.normals[index] * normal).sum(axis=2)) > _NORMALS_WITHIN
    return np.asarray((found & parallel).mean(axis=1), dtype=np.float64)


def _refined(hypothesis: Array, ridge: Ridge, nearest: _NearestRidge, axes: AxisRange) -> RingCandidate | None:
    """The hypothesis refitted to the ridge points along it, three times, ever more closely."""
    form = hypothesis
    for within_px in (2.0 * _LOOSE_PX, _LOOSE_PX):
        nearer = fit_ellipse(ridge.points[followers(form, ridge, within_px)])
        if nearer is None:
            return None
        form = _form(nearer)
    ellipse = fit_ellipse(ridge.points[followers(form, ridge, _TIGHT_PX)])
    if ellipse is None or not len(_plausible(_form(ellipse)[None], axes)):
        return None
    support = _supports(_form(ellipse)[None], ridge, nearest, _FINE_SAMPLES, _TIGHT_PX)
    return RingCandidate(ellipse, float(support[0]))


def followers(form: Array, ridge: Ridge, within_px: float) -> NDArray[np.bool_]:
    """Which ridge points follow an ellipse (5,): near it, by Sampson's distance, and in its direction."""
    u, v, a, b, c = form
    x, y = ridge.points[:, 0] - u, ridge.points[:, 1] - v
    gradient = np.column_stack((2.0 * a * x + b * y, b * x + 2.0 * c * y))
    length = np.linalg.norm(gradient, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.abs(a * x * x + b * x * y + c * y * y - 1.0) / length
        parallel = np.abs((gradient * ridge.normals).sum(axis=1)) / length
    return np.asarray((distance < within_px) & (parallel > _NORMALS_WITHIN))


def _form(ellipse: Ellipse) -> Array:
    """Centre and A, B, C (5,) of an ellipse."""
    conic = conic_from_ellipse(ellipse)
    return np.array([*ellipse.centre_px, conic[0, 0], 2.0 * conic[0, 1], conic[1, 1]])


def _same(one: Ellipse, other: Ellipse) -> bool:
    apart = np.abs(np.subtract(one.centre_px + one.semi_axes_px, other.centre_px + other.semi_axes_px))
    return bool(apart.max() < _SAME_PX)
