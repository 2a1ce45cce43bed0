"""The two rings among whatever else the image shows: ellipses voted for by oriented ridge points.

Three points with tangents fix an ellipse. Two of them are taken from one unbroken piece of ridge, which mostly is one
wire's, so that few triples suffice even where rings are broken and clutter is common; only what then finds ridge points
all around is kept.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.conics import Ellipse, fit_ellipse
from vision.ellipse_forms import centres, dot, form_from, gradients, length, semi_axes
from vision.ridge_map import RidgeMap
from vision.wires import Ridge

Array = NDArray[np.float64]

LEAST_SUPPORT = 0.4  # of a circumference with ridge points; what is really seen is measured and judged later (gates)
_FEWEST_POINTS = 50  # of a ridge: no ring has fewer
_SAMPLES = 32  # on the circumference, for the first look
_FINE_SAMPLES = 120
_LOOSE, _TIGHT = 1.5, 0.75  # distance of a ridge point from the ellipse it supports, in spacings of the ridge
_NORMALS_WITHIN = 0.95  # cosine of the angle between the ridge's normal and the ellipse's
_LEAST_FIRST_SUPPORT = 0.2  # of a triple's own ellipse, which is much less exact than a refitted one
_ALIKE = 3.0  # spacings in centre and axes, between hypotheses that refine to the same ring
_SAME = 3.0  # the same, between ellipses that are one
_COMPARED = 1 << 10  # ellipses that are told apart at a time: mostly the first hold enough
_AT_ONCE = 1 << 13  # triples tried together: what a processor keeps near it
_SEED = 20  # of the triples: the same image gives the same registration


@dataclass(frozen=True, slots=True)
class Effort:
    """How hard to look: triples tried and the most hypotheses that are refined."""

    triples: int
    refined: int


QUICK = Effort(3_000, 40)  # enough for rings as conspicuous as they mostly are
BESIDE = Effort(30_000, 80)  # in what a guide leaves: some triples of a ring of 300 points among 5,000
THOROUGH = Effort(100_000, 150)  # a faint ring among 5,000 ridge points still gets tens of triples of its own


@dataclass(frozen=True, slots=True)
class AxisRange:
    """Plausible semi-major axes of a ring, px, and the least ratio of the axes."""

    least_px: float
    greatest_px: float
    least_ratio: float = math.cos(math.radians(52.0))  # 45 deg of tilt and the perspective's share

    def holds(self, forms: Array) -> NDArray[np.bool_]:
        """Which ellipses (h, 5) look like a ring."""
        major, minor = semi_axes(forms)
        with np.errstate(invalid="ignore"):
            fits = (major > self.least_px) & (major < self.greatest_px) & (minor > self.least_ratio * major)
        return np.asarray(fits)


@dataclass(frozen=True, slots=True)
class RingCandidate:
    """An ellipse, corrected pixels, and the share of its circumference on which ridge points lie."""

    ellipse: Ellipse
    support: float


def ring_candidates(ridge: Ridge, axes: AxisRange, effort: Effort = THOROUGH) -> list[RingCandidate]:
    """Ellipses that ridge points follow.

    Parameters
    ----------
    ridge : Ridge
        Corrected pixels.
    axes : AxisRange
        What a ring may look like.
    effort : Effort
        How hard to look.

    Returns
    -------
    list[RingCandidate]
        Best supported first, each at least `LEAST_SUPPORT`, no two of them the same.
    """
    if len(ridge.points) < _FEWEST_POINTS:
        return []
    nearest = RidgeMap(ridge)
    return _refined(_hypotheses(ridge, nearest, axes, effort.triples), ridge, nearest, axes, effort)


def rings_near(forms: Array, ridge: Ridge, axes: AxisRange, effort: Effort) -> list[RingCandidate]:
    """As `ring_candidates`, of ellipses (h, 5) that are known to some pixels."""
    if len(ridge.points) < _FEWEST_POINTS:
        return []
    return _refined(forms[axes.holds(forms)], ridge, RidgeMap(ridge), axes, effort)


def _refined(forms: Array, ridge: Ridge, nearest: RidgeMap, axes: AxisRange, effort: Effort) -> list[RingCandidate]:
    """The best of some ellipses (h, 5), laid onto the ridges that they follow."""
    support = nearest.support(forms, _SAMPLES, _LOOSE, _NORMALS_WITHIN)
    forms = forms[_different(forms, support, _LEAST_FIRST_SUPPORT, _ALIKE * ridge.spacing_px, effort)]
    for within in (2.0 * _LOOSE, _LOOSE, _LOOSE, _TIGHT):
        forms = nearest.refitted(forms, _FINE_SAMPLES, within, _NORMALS_WITHIN)
        forms = forms[axes.holds(forms)]
    support = nearest.support(forms, _FINE_SAMPLES, _TIGHT, _NORMALS_WITHIN)
    chosen = _different(forms, support, LEAST_SUPPORT, _SAME * ridge.spacing_px, effort)
    followers = (nearest.followers(forms[index], _TIGHT, _NORMALS_WITHIN) for index in chosen)
    ellipses = (fit_ellipse(ridge.points[on]) for on in followers)
    found = zip(ellipses, support[chosen].tolist(), strict=True)
    return [RingCandidate(ellipse, share) for ellipse, share in found if ellipse is not None]


def _hypotheses(ridge: Ridge, nearest: RidgeMap, axes: AxisRange, triples: int) -> Array:
    """Plausible ellipses (h, 5) through random triples, whose first two points share a piece of ridge."""
    random = np.random.default_rng(_SEED)
    count, piece = len(ridge.points), nearest.pieces()
    by_piece = np.argsort(piece, kind="stable")
    size = np.bincount(piece)
    start = np.cumsum(size) - size
    first = random.integers(0, count, triples)
    second, third = (
        by_piece[start[piece[first]] + (random.random(triples) * size[piece[first]]).astype(np.intp)] for _ in range(2)
    )
    third[::2] = random.integers(0, count, len(third[::2]))
    points, normals = (np.ascontiguousarray(vectors.T) for vectors in (ridge.points, ridge.normals))
    some = np.array_split(np.stack((first, second, third)), triples // _AT_ONCE + 1, axis=1)
    return np.concatenate([_through(points, normals, few, axes) for few in some])


def _through(points: Array, normals: Array, triple: NDArray[np.intp], axes: AxisRange) -> Array:
    """Plausible ellipses (h, 5) through triples (3, k) of ridge points (2, n), by their tangents."""
    widths_px = (np.ptp(axis[triple], axis=0) for axis in points)
    triple = triple[:, np.maximum(*widths_px) < 2.0 * axes.greatest_px]
    p, n = points.take(triple, axis=1), normals.take(triple, axis=1)
    forms = form_from(centres(p, n), p)
    with np.errstate(invalid="ignore", over="ignore"):
        slope = gradients(forms, p - forms[:2, None])
        tangent = (np.abs(dot(slope, n)) > _NORMALS_WITHIN * length(slope)).all(axis=0)
    found = np.ascontiguousarray(forms[:, tangent].T)
    return np.asarray(found[axes.holds(found)])


def _different(forms: Array, support: Array, least: float, alike_px: float, effort: Effort) -> list[int]:
    """Indices of the best supported of the ellipses (h, 5), leaving out those like a better one.

    A conspicuous circle (the guide's housing seen end-on) is voted for by hundreds of triples, which would crowd out
    the guide's own rings.
    """
    order = np.argsort(-support, kind="stable")
    order = order[support[order] >= least]
    measures = np.stack((*forms[:, :2].T, *semi_axes(forms)))
    chosen: list[int] = []
    for start in range(0, len(order), _COMPARED):
        some = order[start : start + _COMPARED]
        for one in chosen:
            some = some[_differ(measures, some, one, alike_px)]
        while len(some) and len(chosen) < effort.refined:
            chosen.append(int(some[0]))
            some = some[_differ(measures, some, chosen[-1], alike_px)]
        if len(chosen) == effort.refined:
            break
    return chosen


def _differ(measures: Array, some: NDArray[np.intp], one: int, alike_px: float) -> NDArray[np.bool_]:
    """Which of some ellipses are not like one, by their measures (4, h)."""
    return np.asarray(np.abs(measures[:, some] - measures[:, one, None]).max(axis=0) > alike_px)
