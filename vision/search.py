"""The guide in a corrected image: candidates, each refined and judged, and the only one that passes."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vision import gates
from vision.candidates import Candidates, completed, find_candidates, rings_left
from vision.corrected_image import CorrectedImage
from vision.detection import QUICK, THOROUGH, Effort, RingCandidate
from vision.devices import CArm, Guide
from vision.first_pose import LEAST_LINE_CONTRAST, FirstView, RingView, first_views
from vision.measuring import Scene
from vision.other_ring import other_rings
from vision.refusal import Refusal, RefusalCode
from vision.ring_likeness import is_beside, is_one_ring, lies_on, may_be_hidden, rings_of
from vision.solution import Attempt, Round, Solution, solve
from vision.wire_model import sample_wires

_FINAL = frozenset({RefusalCode.MIRRORED, RefusalCode.AMBIGUOUS})  # looking harder changes nothing about these
_HARDLY_THERE = 0.75  # of a ring's circumference with ridge points; arcs of other things reach 0.6
_REFITTED_WITHIN = 0.01  # of the small ring's size: refits to the same wires agree to some tenths of a pixel
_RING_SUPPORT = 0.6  # of a ring: what only looks like one has half of its circumference by chance


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
        Those that passed, no two of them one guide.
    outcome : Solution or Refusal
        The only one that passed, or why there is none.
    """

    candidates: Candidates
    attempts: list[Attempt]
    passed: list[Attempt]
    outcome: Solution | Refusal


def search(image: CorrectedImage, scene: Scene, carm: CArm) -> Search:
    """A quick search, a thorough one where that finds no solution, one for the other ring of each clear one.

    Then one for the guide of a ring left over (H07).
    """
    found = _search(image, scene, carm, QUICK)
    if _goes_on(found.outcome):
        found = _search(image, scene, carm, THOROUGH, found.passed)
    if _goes_on(found.outcome):
        found = _beside_unpaired(found, scene, image)
    return found if isinstance(found.outcome, Refusal) else _with_others(found, found.outcome, scene, image)


def _goes_on(outcome: Solution | Refusal) -> bool:
    """Whether looking harder may find what is not found yet."""
    return isinstance(outcome, Refusal) and outcome.code not in _FINAL


def _search(image: CorrectedImage, scene: Scene, carm: CArm, effort: Effort, known: Sequence[Attempt] = ()) -> Search:
    """One search; a first view that lies on a guide known from another search is not refined to it once more."""
    return _tried(find_candidates(image, scene.guide, carm, scene.priors, effort), [], known, scene, image)


def _beside_unpaired(found: Search, scene: Scene, image: CorrectedImage) -> Search:
    """The search gone on with what belongs to rings that are clearly there, each looked for where it must be.

    A faint ring's ellipse, found by itself, may be too rough to make a pair.
    """
    unpaired = _clear_unpaired(found.candidates)
    if not unpaired:
        return found
    others = completed(found.candidates, unpaired, found.candidates.ridge, scene.guide, scene.priors)
    return found if isinstance(others.pairs, Refusal) else _tried(others, found.attempts, found.passed, scene, image)


def _clear_unpaired(candidates: Candidates) -> list[RingCandidate]:
    """Rings that are clearly there and in no pair."""
    pairs = [] if isinstance(candidates.pairs, Refusal) else candidates.pairs
    paired = [ring for pair in pairs for ring in (pair.rings.small, pair.rings.big)]
    clear = (ring for ring in candidates.rings if ring.support > _HARDLY_THERE)
    return [ring for ring in clear if not any(is_one_ring(ring.ellipse, other) for other in paired)]


def _with_others(found: Search, solution: Solution, scene: Scene, image: CorrectedImage) -> Search:
    """The search gone on for another guide where the solution leaves a clear ring over."""
    rings, left = rings_left(found.candidates, sample_wires(solution.fit.view, solution.fit.guide).points)
    beside = _clear_beside(rings, solution)
    if not beside:
        return found
    others = completed(found.candidates, beside, left, scene.guide, scene.priors)
    if not isinstance(others.pairs, Refusal):
        found = _tried(others, found.attempts, found.passed, scene, image)
    return _without_hidden(found, beside, scene)


def _without_hidden(found: Search, beside: list[RingCandidate], scene: Scene) -> Search:
    """The search; its solution refused where it may hide the other ring of a guide of which one ring is left over."""
    if isinstance(found.outcome, Refusal):
        return found
    own = rings_of(found.outcome.fit.view, found.outcome.fit.guide)
    clear = (ring.ellipse for ring in beside if ring.support > _HARDLY_THERE)
    others = (other_rings(ring, scene.guide, scene.priors.nominal) for ring in clear)
    if not any(may_be_hidden(forms, own) for forms in others):
        return found
    message = "guides that may be in the image, by a ring whose other one may lie on this guide's"
    return replace(found, outcome=Refusal(RefusalCode.AMBIGUOUS, message, 2, 1))


def _clear_beside(rings: list[RingCandidate], solution: Solution) -> list[RingCandidate]:
    """Rings that are clearly there and none of the solution's, each once."""
    beside: list[RingCandidate] = []
    own = rings_of(solution.fit.view, solution.fit.guide)
    for ring in rings:
        known = any(is_one_ring(ring.ellipse, other.ellipse) for other in beside)
        if not known and ring.support > _RING_SUPPORT and is_beside((ring.ellipse,), own):
            beside.append(ring)
    return beside


def _tried(
    candidates: Candidates,
    attempts: Sequence[Attempt],
    known: Sequence[Attempt],
    scene: Scene,
    image: CorrectedImage,
) -> Search:
    """What becomes of candidates, beside earlier attempts."""
    if isinstance(candidates.pairs, Refusal):
        return Search(candidates, [], [], candidates.pairs)
    attempts = list(attempts)
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
        rings_of(attempt.last.fit.view, attempt.last.fit.guide)
        for attempt in attempts
        if attempt.outcome is not solution and attempt.last and _holds_both_rings(attempt.last)
    ]
    own = rings_of(solution.fit.view, solution.fit.guide)
    return any(is_beside(rings, own) for rings in (*found, *fitted))


def _holds_both_rings(fitted: Round) -> bool:
    measured = fitted.measured
    refusal = gates.check_coverage(fitted.fit, measured.observations, measured.places)
    return (refusal or gates.check_residual(fitted.fit)) is None


def _is_remnant(pair: RingView, outcome: Solution | Refusal) -> bool:
    """Whether a pair is made of one ring of a guide that passed and of another that is hardly there."""
    if isinstance(outcome, Refusal) or min(pair.supports) > _HARDLY_THERE:
        return False
    both = itertools.product((pair.rings.small, pair.rings.big), rings_of(outcome.fit.view, outcome.fit.guide))
    return any(is_one_ring(found, ring) for found, ring in both)


def _known(first: FirstView, known: Sequence[Attempt], guide: Guide) -> Attempt | None:
    """The attempt that passed to which a first view would lead again, if any."""
    return next(
        (
            one
            for one in known
            if isinstance(one.outcome, Solution)
            and lies_on(first.view, guide, one.outcome.fit.view, one.outcome.fit.guide)
        ),
        None,
    )


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
    """Those that passed, the first of each guide."""
    passed: dict[int, Solution] = {}
    for index, attempt in enumerate(attempts):
        outcome = attempt.outcome
        if isinstance(outcome, Solution) and not any(_one_guide(outcome, other) for other in passed.values()):
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


def _one_guide(one: Solution, other: Solution) -> bool:
    """Whether two solutions lie on the same wires: views that differ by what no image tells well are one guide's."""
    return lies_on(one.fit.view, one.fit.guide, other.fit.view, other.fit.guide, _REFITTED_WITHIN)
