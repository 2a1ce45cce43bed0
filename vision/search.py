"""The guide in a corrected image: candidates, each refined and judged, and the only one that passes."""

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision import gates
from vision.candidates import Candidates, find_candidates
from vision.conics import Ellipse, ellipse_from_conic
from vision.contour import ContourFit
from vision.corrected_image import CorrectedImage
from vision.detection import QUICK, THOROUGH, Effort
from vision.devices import CArm, Guide
from vision.first_pose import LEAST_LINE_CONTRAST, FirstView, RingView, first_views
from vision.measuring import Scene
from vision.projection import View, project, ring_conic
from vision.refusal import Refusal, RefusalCode
from vision.solution import Attempt, Round, Solution, solve
from vision.wire_model import sample_wires

Array = NDArray[np.float64]

_FINAL = frozenset({RefusalCode.MIRRORED, RefusalCode.AMBIGUOUS})  # looking harder changes nothing about these
_HARDLY_THERE = 0.75  # of a ring's circumference with ridge points; arcs of other things reach 0.6
_RING_SUPPORT = 0.6  # of a ring: what only looks like one has half of its circumference by chance
_ONE_RING_WITHIN = 0.03  # of its size, in centre and axes
_BESIDE_RING = 0.12  # the same, of ellipses that follow the greater part of one ring and nothing else
_SAME_WITHIN_MM = 1.0  # refits of one guide agree far better, two guides cannot be so near
_SAME_WITHIN_RAD = math.radians(3.0)


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """One search through an image.

    Attributes
    ----------
    candidates : Candidates
        Rings, and the first views made of them.
    attempts : list[Attempt]
        What became of each first view.
    passed : list[Attempt]
        Those that passed, no two of them the same view.
    outcome : Solution or Refusal
        The only one that passed, or why there is none.
    """

    candidates: Candidates
    attempts: list[Attempt]
    passed: list[Attempt]
    outcome: Solution | Refusal


def search(image: CorrectedImage, scene: Scene, carm: CArm) -> Search:
    """A quick search; a thorough one where that finds no solution, or a ring that the solution leaves over (H07)."""
    quick = _search(image, scene, carm, QUICK)
    if isinstance(quick.outcome, Refusal):
        return quick if quick.outcome.code in _FINAL else _search(image, scene, carm, THOROUGH, quick.passed)
    left_over = [ring.ellipse for ring in quick.candidates.rings if ring.support > _RING_SUPPORT]
    if any(_is_beside((ring,), quick.outcome) for ring in left_over):
        return _search(image, scene, carm, THOROUGH, quick.passed)
    return quick


def _search(image: CorrectedImage, scene: Scene, carm: CArm, effort: Effort, known: Sequence[Attempt] = ()) -> Search:
    """One search; a first view that lies on a guide known from another search is not refined to it once more."""
    candidates = find_candidates(image, scene.guide, carm, scene.priors, effort)
    if isinstance(candidates.pairs, Refusal):
        return Search(candidates, [], [], candidates.pairs)
    attempts: list[Attempt] = []
    for pair in candidates.pairs:
        if not any(_is_remnant(pair, attempt.outcome) for attempt in attempts):
            firsts = first_views(pair, scene.guide, candidates.directions, scene.reader)
            attempts += [_known(first, known, scene.guide) or _attempt(first, scene, image) for first in firsts]
    passed = _passed(attempts)
    outcome = _only_outcome(passed, attempts)
    if isinstance(outcome, Solution) and _sees_other_guide(candidates.pairs, attempts, outcome):
        message = "guides seen in the image, by their rings"
        outcome = Refusal(RefusalCode.AMBIGUOUS, message, 2, 1)
    return Search(candidates, attempts, passed, outcome)


def _sees_other_guide(pairs: list[RingView], attempts: list[Attempt], solution: Solution) -> bool:
    """Whether both rings of another guide are clearly there, found or fitted, whatever became of its line and bead."""
    found = [(pair.rings.small, pair.rings.big) for pair in pairs if min(pair.supports) > _HARDLY_THERE]
    fitted = [
        _rings_of(attempt.last.fit.view, attempt.last.fit.guide)
        for attempt in attempts
        if attempt.last and _holds_both_rings(attempt.last)
    ]
    return any(_is_beside(rings, solution) for rings in (*found, *fitted))


def _holds_both_rings(fitted: Round) -> bool:
    measured = fitted.measured
    refusal = gates.check_coverage(fitted.fit, measured.observations, measured.places)
    return (refusal or gates.check_residual(fitted.fit)) is None


def _is_beside(rings: Iterable[Ellipse], solution: Solution) -> bool:
    """Whether no ring is one of the solution's."""
    both = itertools.product(rings, _rings_of(solution.fit.view, solution.fit.guide))
    return not any(_one_ring(ring, own, _BESIDE_RING) for ring, own in both)


def _is_remnant(pair: RingView, outcome: Solution | Refusal) -> bool:
    """Whether a pair is made of one ring of a guide that passed and of another that is hardly there."""
    if isinstance(outcome, Refusal) or min(pair.supports) > _HARDLY_THERE:
        return False
    both = itertools.product((pair.rings.small, pair.rings.big), _rings_of(outcome.fit.view, outcome.fit.guide))
    return any(_one_ring(found, ring) for found, ring in both)


def _rings_of(view: View, guide: Guide) -> tuple[Ellipse, ...]:
    """The ellipses of a guide's rings in a view."""
    conics = (
        ring_conic(view, guide.small_ring_radius_mm, 0.0),
        ring_conic(view, guide.big_ring_radius_mm, -guide.separation_mm),
    )
    return tuple(ellipse for ellipse in map(ellipse_from_conic, conics) if ellipse is not None)


def _one_ring(one: Ellipse, other: Ellipse, within: float = _ONE_RING_WITHIN) -> bool:
    apart = np.abs(np.subtract(one.centre_px + one.semi_axes_px, other.centre_px + other.semi_axes_px))
    return bool(apart.max() < within * other.semi_axes_px[0])


def _known(first: FirstView, known: Sequence[Attempt], guide: Guide) -> Attempt | None:
    """The attempt that passed to which a first view would lead again, if any."""
    return next(
        (one for one in known if isinstance(one.outcome, Solution) and _lies_on(first.view, guide, one.outcome.fit)),
        None,
    )


def _lies_on(view: View, guide: Guide, fit: ContourFit) -> bool:
    """Whether a view's rings and line are those of a fit."""
    rings, own = _rings_of(view, guide), _rings_of(fit.view, fit.guide)
    if len(rings) != len(own) or not all(map(_one_ring, rings, own)):
        return False
    apart_px = np.abs(_line_ends_px(view, guide) - _line_ends_px(fit.view, fit.guide)).max()
    return bool(apart_px < _ONE_RING_WITHIN * own[0].semi_axes_px[0])


def _line_ends_px(view: View, guide: Guide) -> Array:
    """Projected ends (2, 2) of the line."""
    return project(view, np.array([[guide.line_start_mm, 0.0, 0.0], [guide.line_end_mm, 0.0, 0.0]]))


def _attempt(first: FirstView, scene: Scene, image: CorrectedImage) -> Attempt:
    refusal = _judged_first(first, scene.guide, image)
    if refusal is not None:
        return Attempt(first, None, refusal)
    try:
        return solve(first, scene)
    except np.linalg.LinAlgError:  # what looked like a guide and runs away in the fit is none
        message = "a view that the guide file cannot explain at all: solutions found"
        return Attempt(first, None, Refusal(RefusalCode.GUIDE_MISMATCH, message, 0, 1))


def _passed(attempts: list[Attempt]) -> list[Attempt]:
    """Those that passed, the first of each view."""
    passed: dict[int, Solution] = {}
    for index, attempt in enumerate(attempts):
        outcome = attempt.outcome
        if isinstance(outcome, Solution) and not any(_same(outcome, other) for other in passed.values()):
            passed[index] = outcome
    return [attempts[index] for index in passed]


def _only_outcome(passed: list[Attempt], attempts: list[Attempt]) -> Solution | Refusal:
    """That of the one view that passed; the best supported view's refusal where none did, `ambiguous` where two did."""
    if len(passed) > 1:
        return Refusal(RefusalCode.AMBIGUOUS, "guides seen in the image", len(passed), 1)
    return (passed or attempts)[0].outcome


def _judged_first(first: FirstView, guide: Guide, image: CorrectedImage) -> Refusal | None:
    """What makes refining a first view pointless."""
    share = image.share_inside(sample_wires(first.view, guide).points)
    if share < 1.0:
        return Refusal(RefusalCode.GUIDE_CUT_OFF, "share of the guide's wires inside the field", share, 1.0)
    if first.line_contrast < LEAST_LINE_CONTRAST:
        message = "contrast of the indicator line against the rings'"
        return Refusal(RefusalCode.LINE_MISSING, message, first.line_contrast, LEAST_LINE_CONTRAST)
    return None


def _same(one: Solution, other: Solution) -> bool:
    """The same place and the same turn about the axis."""
    a, b = one.fit.view.source_from_guide, other.fit.view.source_from_guide
    near = float(np.linalg.norm(a[:3, 3] - b[:3, 3])) < _SAME_WITHIN_MM
    return near and float(a[:3, 0] @ b[:3, 0]) > math.cos(_SAME_WITHIN_RAD)
