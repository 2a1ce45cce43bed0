"""The other ring of a guide is looked for where it is, whichever ring is seen and however the guide is tilted."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision.conics import Ellipse, ellipse_from_conic
from vision.devices import Guide
from vision.ellipse_forms import semi_axes
from vision.other_ring import other_rings
from vision.projection import View, ring_conic

FOLLOWED_PX = 6.0  # so far a refit follows a ring of this size


def rings(view: View, guide: Guide) -> tuple[Ellipse, Ellipse]:
    """Small and big."""
    small = ellipse_from_conic(ring_conic(view, guide.small_ring_radius_mm, 0.0))
    big = ellipse_from_conic(ring_conic(view, guide.big_ring_radius_mm, -guide.separation_mm))
    assert small is not None
    assert big is not None
    return small, big


def off_px(ring: Ellipse, wanted: Ellipse, view: View, guide: Guide) -> float:
    """How far the nearest of the ellipses told lies from the one wanted, in centre and axes."""
    forms = other_rings(ring, guide, view.intrinsics)
    told = np.column_stack((forms[:, :2], *semi_axes(forms)))
    return float(np.abs(told - (*wanted.centre_px, *wanted.semi_axes_px)).max(axis=1).min())


@given(tilt_deg=st.floats(0.0, 40.0), azimuth_deg=st.floats(0.0, 360.0))
def test_one_ring_tells_where_the_other_is(
    tilt_deg: float, azimuth_deg: float, guide: Guide, make_view: Callable[..., View]
) -> None:
    view = make_view(tilt_deg, azimuth_deg)
    small, big = rings(view, guide)
    assert off_px(small, big, view, guide) < FOLLOWED_PX
    assert off_px(big, small, view, guide) < FOLLOWED_PX


@pytest.mark.parametrize("tilt_deg", [0.0, 20.0])
def test_axes_that_are_a_little_off_are_forgiven(tilt_deg: float, guide: Guide, make_view: Callable[..., View]) -> None:
    view = make_view(tilt_deg)
    small, big = rings(view, guide)
    major_px, minor_px = big.semi_axes_px
    seen = Ellipse(big.centre_px, (major_px + 1.0, minor_px - 1.0), big.angle_rad)
    assert off_px(seen, small, view, guide) < FOLLOWED_PX


def test_a_ring_seen_obliquely_leaves_few_places(guide: Guide, make_view: Callable[..., View]) -> None:
    along, oblique = (
        len(other_rings(rings(make_view(tilt), guide)[0], guide, make_view(tilt).intrinsics)) for tilt in (0.0, 30.0)
    )
    assert oblique < along / 2
