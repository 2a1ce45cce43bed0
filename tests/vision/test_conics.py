from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision.conics import (
    Ellipse,
    RingPair,
    conic_from_ellipse,
    ellipse_from_conic,
    fiducials,
    fit_ellipse,
    true_centres,
)
from vision.devices import Guide
from vision.projection import Intrinsics, View, fiducials_in_guide, project, ring_conic
from vision.refusal import Refusal, RefusalCode

NOMINAL = Intrinsics(2844.4444, 2844.4444, 511.5, 511.5)
TILTS_DEG = st.floats(0.0, 40.0)
TURNS_DEG = st.floats(0.0, 360.0)

ellipses = st.builds(
    lambda u, v, major, ratio, angle: Ellipse((u, v), (major, major * ratio), angle),
    st.floats(0.0, 1024.0),
    st.floats(0.0, 1024.0),
    st.floats(20.0, 300.0),
    st.floats(0.3, 0.98),  # a circle has no major axis to compare
    st.floats(-1.5, 1.5),
)


def rings_of(view: View, guide: Guide) -> RingPair:
    """The exact ellipses of both rings."""
    small = ellipse_from_conic(ring_conic(view, guide.small_ring_radius_mm, 0.0))
    big = ellipse_from_conic(ring_conic(view, guide.big_ring_radius_mm, -guide.separation_mm))
    assert small is not None
    assert big is not None
    return RingPair(small, big)


def points_on(ellipse: Ellipse, around_rad: np.ndarray) -> np.ndarray:
    """Points (n, 2) of an ellipse."""
    cosine, sine = np.cos(ellipse.angle_rad), np.sin(ellipse.angle_rad)
    flat = np.column_stack((np.cos(around_rad), np.sin(around_rad))) * ellipse.semi_axes_px
    return flat @ np.array([[cosine, sine], [-sine, cosine]]) + ellipse.centre_px


def assert_same(found: Ellipse | None, expected: Ellipse, tolerance: float) -> None:
    """Equal within `tolerance` px, the angle at the end of the major axis; an angle and its opposite are one."""
    assert found is not None
    assert found.centre_px == pytest.approx(expected.centre_px, abs=tolerance)
    assert found.semi_axes_px == pytest.approx(expected.semi_axes_px, abs=tolerance)
    turned = abs(np.sin(found.angle_rad - expected.angle_rad)) * expected.semi_axes_px[0]
    assert turned < tolerance * 100.0  # the axes of a nearly round ellipse are loose


@given(ellipses, st.floats(0.1, 10.0), st.sampled_from([1.0, -1.0]))
def test_ellipse_and_conic_are_a_round_trip_at_any_scale(ellipse: Ellipse, scale: float, sign: float) -> None:
    assert_same(ellipse_from_conic(conic_from_ellipse(ellipse) * scale * sign), ellipse, 1e-6)


@given(ellipses, st.floats(0.0, 6.0), st.floats(2.5, 6.28))
def test_ellipse_is_fitted_to_points_of_an_arc(ellipse: Ellipse, start: float, extent: float) -> None:
    found = fit_ellipse(points_on(ellipse, np.linspace(start, start + extent, 60)))
    assert_same(found, ellipse, 1e-4)


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((10, 2)),
        np.column_stack((np.arange(10.0), np.zeros(10))),
        np.column_stack((np.arange(10.0), np.arange(10.0))),
        np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 2.0]]),
    ],
    ids=["one-point", "horizontal", "diagonal", "too-few"],
)
def test_no_ellipse_through_degenerate_points(points: np.ndarray) -> None:
    assert fit_ellipse(points) is None


def test_no_ellipse_in_hyperbola_imaginary_or_empty_conic() -> None:
    assert ellipse_from_conic(np.diag([1.0, -1.0, -1.0])) is None
    assert ellipse_from_conic(np.diag([1.0, 1.0, 1.0])) is None
    assert ellipse_from_conic(np.zeros((3, 3))) is None


@given(TILTS_DEG, TURNS_DEG, TURNS_DEG)
def test_true_centres_are_exact_with_exact_intrinsics(
    make_view: Callable[..., View], guide: Guide, tilt_deg: float, azimuth_deg: float, roll_deg: float
) -> None:
    view = make_view(tilt_deg, azimuth_deg, roll_deg)
    centres = true_centres(rings_of(view, guide), guide, view.intrinsics)
    assert not isinstance(centres, Refusal)
    expected = project(view, np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -guide.separation_mm]]))
    # px; four rounds leave this at 40 deg, far below what an image tells
    assert np.abs(centres.small_px - expected[0]).max() < 2e-3
    assert np.abs(centres.big_px - expected[1]).max() < 5e-3
    pose = view.source_from_guide
    assert centres.depth_ratio == pytest.approx((pose[:3, 3] - 60.0 * pose[:3, 2])[2] / pose[2, 3], abs=1e-5)


def test_ellipse_centres_are_not_the_ring_centres(vector_view: View, guide: Guide) -> None:
    rings = rings_of(vector_view, guide)
    centres = true_centres(rings, guide, NOMINAL)
    assert not isinstance(centres, Refusal)
    assert np.linalg.norm(centres.small_px - rings.small.centre_px) == pytest.approx(0.3463, abs=1e-3)


def test_true_centres_are_exact_when_aligned(make_view: Callable[..., View], guide: Guide) -> None:
    view = make_view(0.0, translation_mm=(0.0, 0.0, 750.0))
    centres = true_centres(rings_of(view, guide), guide, NOMINAL)
    assert not isinstance(centres, Refusal)
    assert centres.small_px == pytest.approx((511.5, 511.5), abs=1e-6)
    assert centres.big_px == pytest.approx((511.5, 511.5), abs=1e-6)


@given(TILTS_DEG, TURNS_DEG, TURNS_DEG)
def test_fiducials_are_where_the_points_project(
    make_view: Callable[..., View], guide: Guide, tilt_deg: float, azimuth_deg: float, roll_deg: float
) -> None:
    view = make_view(tilt_deg, azimuth_deg, roll_deg, centre_px=(518.0, 505.0), alpha_px=2900.0)
    names, points = zip(*fiducials_in_guide(guide).items(), strict=True)
    expected = dict(zip(names, project(view, np.array(points)), strict=True))
    found = fiducials(rings_of(view, guide), expected["line_start"], expected["line_end"], guide, NOMINAL)
    assert not isinstance(found, Refusal)
    assert list(found) == list(names)
    # px: the nominal intrinsics are 2 % and 9 px off, as they are in a room, and that counts in proportion to the tilt
    tolerance_px = 0.02 + 0.006 * tilt_deg
    for name in names:
        assert np.abs(found[name] - expected[name]).max() < tolerance_px, name


def test_exchanged_rings_are_refused(vector_view: View, guide: Guide) -> None:
    rings = rings_of(vector_view, guide)
    refusal = true_centres(RingPair(small=rings.big, big=rings.small), guide, NOMINAL)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.GUIDE_MISMATCH
    start, end = np.array([600.0, 500.0]), np.array([700.0, 500.0])
    assert isinstance(fiducials(RingPair(rings.big, rings.small), start, end, guide, NOMINAL), Refusal)
