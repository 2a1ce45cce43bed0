"""Pairs of ellipses laid onto the guide's rings: together, and none the worse for another that runs away."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from vision.conics import RingPair, ellipse_from_conic
from vision.devices import CArm, Guide
from vision.first_pose import RingView
from vision.priors import Priors
from vision.projection import View, nominal_intrinsics, ring_conic
from vision.ring_alignment import aligned


@pytest.fixture
def priors(flat_panel: CArm, guide: Guide) -> Priors:
    """Of a flat panel of 1024 pixels."""
    nominal = nominal_intrinsics(flat_panel, 1024, 1024, flat_panel.field_of_view_mm / 1024)
    return Priors.of(flat_panel, guide, nominal)


def pair_of(view: View, guide: Guide) -> RingView:
    """The ellipses that a view shows, and the view itself."""
    small = ellipse_from_conic(ring_conic(view, guide.small_ring_radius_mm, 0.0))
    big = ellipse_from_conic(ring_conic(view, guide.big_ring_radius_mm, -guide.separation_mm))
    return RingView(RingPair(small, big), (1.0, 1.0), view)


def moved(pair: RingView, by_mm: tuple[float, float, float]) -> RingView:
    """The same ellipses with a first view a way off."""
    pose = pair.view.source_from_guide.copy()
    pose[:3, 3] += by_mm
    return replace(pair, view=View(pair.view.intrinsics, pose))


def test_a_view_that_is_off_by_some_millimetres_is_laid_onto_its_ellipses(
    make_view: Callable[..., View], guide: Guide, priors: Priors
) -> None:
    true = make_view(20.0)
    (laid,) = aligned([moved(pair_of(true, guide), (2.0, -3.0, 15.0))], guide, priors)
    assert laid.view.source_from_guide[:3, 3] == pytest.approx(true.source_from_guide[:3, 3], abs=0.5)


@pytest.mark.parametrize(
    "away_mm", [(0.0, 0.0, -750.0), (0.0, 0.0, -690.0), (math.nan, 0.0, 0.0), (1e300, 0.0, 0.0), (0.0, 0.0, 1e25)]
)
def test_a_pair_that_runs_away_is_left_out_and_leaves_the_others_alone(
    away_mm: tuple[float, float, float], make_view: Callable[..., View], guide: Guide, priors: Priors
) -> None:
    good = pair_of(make_view(12.0), guide)
    (alone,) = aligned([good], guide, priors)
    flat = replace(good, view=View(good.view.intrinsics, np.diag([1.0, 1.0, 1.0, 1.0])))
    laid = aligned([flat, moved(good, away_mm), good], guide, priors)
    assert laid
    assert laid[-1].view.source_from_guide == pytest.approx(alone.view.source_from_guide)


def test_ellipses_far_from_one_axis_are_left_out(make_view: Callable[..., View], guide: Guide, priors: Priors) -> None:
    pair = pair_of(make_view(20.0), guide)
    u_px, v_px = pair.rings.small.centre_px
    aside = replace(pair, rings=RingPair(replace(pair.rings.small, centre_px=(u_px + 200.0, v_px)), pair.rings.big))
    assert aligned([aside], guide, priors) == []
