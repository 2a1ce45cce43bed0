"""Where in the image the guide may be: pairs of rings with a line, the best supported first."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vision.corrected_image import CorrectedImage
from vision.curvature import Curvature
from vision.detection import BESIDE, QUICK, AxisRange, Effort, RingCandidate, ring_candidates, rings_near
from vision.devices import CArm, Guide
from vision.first_pose import LineDirections, RingView, consistent_pairs
from vision.other_ring import other_rings
from vision.priors import Priors
from vision.projection import Intrinsics
from vision.refusal import Refusal, RefusalCode
from vision.ring_alignment import aligned
from vision.wires import Ridge, ridge_points, wire_curvature_sigma_px

Array = NDArray[np.float64]

_NEAREST_SHARE, _FARTHEST_SHARE = 0.45, 0.97  # of the source-to-image distance, where a ring may be
_MOST_PAIRS = 30  # laid onto their ellipses; variants of a conspicuous circle crowd the list
_MOST_VIEWS = 6  # refined in full
_OWN_WITHIN = 2.0  # spacings of the ridge: its points so near to a guide's wires are that guide's


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Rings found in the image, the pairs made of them or why there are none, and where lines show.

    What they were found in: the ridge, and what a ring may look like.
    """

    rings: list[RingCandidate]
    pairs: list[RingView] | Refusal
    directions: LineDirections
    ridge: Ridge
    axes: AxisRange


def wire_width_px(guide: Guide, carm: CArm, nominal: Intrinsics) -> float:
    """Width of a wire's shadow half-way of the plausible distances, px; widths differ by a third at most."""
    depth_mm = carm.source_to_image_mm * (_NEAREST_SHARE + _FARTHEST_SHARE) / 2.0
    return guide.wire_diameter_mm * nominal.alpha_x_px / depth_mm


def find_candidates(image: CorrectedImage, guide: Guide, carm: CArm, priors: Priors, effort: Effort) -> Candidates:
    """Pairs of rings worth looking for a line.

    Parameters
    ----------
    image : CorrectedImage
        Where to look.
    guide, carm, priors
        The device files and what they predict.
    effort : Effort
        How hard to look.

    Returns
    -------
    Candidates
        At least one pair, or a refusal: `no_guide_found` where no ring is seen, `ring_missing` where no two belong
        together.
    """
    nominal = priors.nominal
    curvature = Curvature.of(image.absorption, wire_curvature_sigma_px(wire_width_px(guide, carm, nominal)))
    ridge = ridge_points(curvature, image.plate.map, image.balls_raw)
    per_mm = nominal.alpha_x_px / carm.source_to_image_mm
    axes = AxisRange(
        least_px=per_mm * guide.small_ring_radius_mm / _FARTHEST_SHARE,
        greatest_px=per_mm * guide.big_ring_radius_mm / _NEAREST_SHARE,
    )
    rings = ring_candidates(ridge, axes, effort)
    return Candidates(rings, _pairs(rings, guide, priors), LineDirections(curvature, image.plate.map), ridge, axes)


def rings_left(candidates: Candidates, wires: Array) -> tuple[list[RingCandidate], Ridge]:
    """Rings in what a guide leaves of the ridge, its wires at (n, 2) corrected pixels, and that ridge.

    A guide's own rings, being conspicuous, crowd out fainter ones.
    """
    left = candidates.ridge.beyond(wires, _OWN_WITHIN * candidates.ridge.spacing_px)
    return [*candidates.rings, *ring_candidates(left, candidates.axes, BESIDE)], left


def completed(
    candidates: Candidates, beside: list[RingCandidate], left: Ridge, guide: Guide, priors: Priors
) -> Candidates:
    """The candidates of another guide, some of whose rings are seen: the others are looked for where they must be."""
    forms = np.concatenate([other_rings(ring.ellipse, guide, priors.nominal) for ring in beside])
    rings = [*beside, *rings_near(forms, left, candidates.axes, QUICK)]
    return replace(candidates, rings=[*candidates.rings, *rings], pairs=_pairs(rings, guide, priors))


def _pairs(rings: list[RingCandidate], guide: Guide, priors: Priors) -> list[RingView] | Refusal:
    if not rings:
        return Refusal(RefusalCode.NO_GUIDE_FOUND, "rings of the guide's size found", 0, 2)
    pairs = consistent_pairs(rings, guide, priors.nominal, _MOST_PAIRS)
    if not pairs:
        message = "no two of the rings found belong to one guide: consistent pairs"
        return Refusal(RefusalCode.RING_MISSING, message, 0, 1)
    upright = aligned(pairs, guide, priors)[:_MOST_VIEWS]
    if not upright:
        message = "no two of the rings found can be those of the guide file: pairs that can"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, 0, 1)
    return upright
