"""Which rings are one, and whether a view lies on a guide that is known."""

import itertools
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from vision.conics import Ellipse, ellipse_from_conic
from vision.devices import Guide
from vision.ellipse_forms import semi_axes
from vision.projection import View, project, ring_conic

Array = NDArray[np.float64]

_ONE_RING_WITHIN = 0.03  # of its size, in centre and axes
_BESIDE_RING = 0.12  # the same, of ellipses that follow the greater part of one ring and nothing else


def rings_of(view: View, guide: Guide) -> tuple[Ellipse, ...]:
    """The ellipses of a guide's rings in a view."""
    conics = (
        ring_conic(view, guide.small_ring_radius_mm, 0.0),
        ring_conic(view, guide.big_ring_radius_mm, -guide.separation_mm),
    )
    return tuple(ellipse for ellipse in map(ellipse_from_conic, conics) if ellipse is not None)


def is_one_ring(one: Ellipse, other: Ellipse, within: float = _ONE_RING_WITHIN) -> bool:
    """Whether two ellipses are one ring's."""
    both = zip(one.centre_px + one.semi_axes_px, other.centre_px + other.semi_axes_px, strict=True)
    return max(abs(here - there) for here, there in both) < within * other.semi_axes_px[0]


def is_beside(rings: Iterable[Ellipse], known: Iterable[Ellipse]) -> bool:
    """Whether no ring is one of those known of a guide."""
    return not any(is_one_ring(ring, own, _BESIDE_RING) for ring, own in itertools.product(rings, known))


def may_be_hidden(forms: Array, known: Iterable[Ellipse]) -> bool:
    """Whether one of the ellipses (h, 5) that a ring may have lies on a known ring, beneath which it is not found."""
    measures = np.column_stack((forms[:, :2], *semi_axes(forms)))
    apart_px = ((np.abs(measures - (*ring.centre_px, *ring.semi_axes_px)).max(axis=1), ring) for ring in known)
    return any(bool((px < _BESIDE_RING * ring.semi_axes_px[0]).any()) for px, ring in apart_px)


def lies_on(view: View, guide: Guide, known_view: View, known_guide: Guide, within: float = _ONE_RING_WITHIN) -> bool:
    """Whether a view's rings and line are those of a known one."""
    rings, own = rings_of(view, guide), rings_of(known_view, known_guide)
    if len(rings) != len(own) or not all(is_one_ring(*both, within) for both in zip(rings, own, strict=True)):
        return False
    apart_px = np.abs(_line_ends_px(view, guide) - _line_ends_px(known_view, known_guide)).max()
    return bool(apart_px < within * own[0].semi_axes_px[0])


def _line_ends_px(view: View, guide: Guide) -> Array:
    """Projected ends (2, 2) of the line."""
    return project(view, np.array([[guide.line_start_mm, 0.0, 0.0], [guide.line_end_mm, 0.0, 0.0]]))
