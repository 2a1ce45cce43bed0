from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision.conics import ellipse_from_conic, polar
from vision.devices import CArm, Guide
from vision.projection import (
    View,
    fiducials_in_guide,
    line_image,
    nominal_intrinsics,
    project,
    ring_conic,
)

PRINTED_PX = 5e-5  # half a unit of the last printed digit of the test vector


def test_nominal_intrinsics_are_distance_over_pixel_size(flat_panel: CArm) -> None:
    intrinsics = nominal_intrinsics(flat_panel, 1024, 1024)
    assert intrinsics.alpha_x_px == pytest.approx(2844.4444, abs=PRINTED_PX)
    assert (intrinsics.u0_px, intrinsics.v0_px) == (511.5, 511.5)


def test_ring_ellipses_of_the_test_vector(vector_view: View) -> None:
    small = ellipse_from_conic(ring_conic(vector_view, 20.0, 0.0))
    big = ellipse_from_conic(ring_conic(vector_view, 30.0, -60.0))
    assert small is not None
    assert big is not None
    assert small.centre_px == pytest.approx((549.4267, 492.1907), abs=PRINTED_PX)
    assert big.centre_px == pytest.approx((552.6718, 532.8934), abs=PRINTED_PX)
    assert small.semi_axes_px[0] == pytest.approx(75.8599, abs=PRINTED_PX)
    assert big.semi_axes_px[0] == pytest.approx(123.5237, abs=PRINTED_PX)


def test_ring_centres_of_the_test_vector(vector_view: View) -> None:
    centres = project(vector_view, np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -60.0]]))
    assert centres[0] == pytest.approx((549.4259, 492.5370), abs=PRINTED_PX)
    assert centres[1] == pytest.approx((552.6694, 533.8093), abs=PRINTED_PX)


@given(st.floats(0.0, 40.0), st.floats(0.0, 360.0), st.floats(0.0, 360.0), st.floats(0.0, 360.0))
def test_projected_points_of_a_ring_lie_on_its_conic(
    make_view: Callable[..., View], tilt_deg: float, azimuth_deg: float, roll_deg: float, around_deg: float
) -> None:
    view = make_view(tilt_deg, azimuth_deg, roll_deg)
    around = np.radians(around_deg)
    point = project(view, np.array([[30.0 * np.cos(around), 30.0 * np.sin(around), -60.0]]))[0]
    conic = ring_conic(view, 30.0, -60.0)
    tangent = polar(conic, np.array([*point, 1.0]))
    distance_px = tangent @ (*point, 1.0) / np.linalg.norm(tangent[:2]) / 2.0
    assert abs(distance_px) < 1e-6  # px: rounding only


def test_conic_is_negative_inside(vector_view: View) -> None:
    conic = ring_conic(vector_view, 20.0, 0.0)
    inside, outside = np.array([549.4, 492.5, 1.0]), np.array([649.4, 492.5, 1.0])
    assert inside @ conic @ inside < 0.0 < outside @ conic @ outside


def test_line_image_goes_through_the_projected_line(vector_view: View, guide: Guide) -> None:
    line = line_image(vector_view, guide)
    (middle,) = project(vector_view, np.array([[46.0, 0.0, 0.0]]))
    assert abs(line @ (*middle, 1.0)) / np.linalg.norm(line[:2]) < 1e-9  # px: rounding only


def test_fiducials_are_the_twelve_of_the_contract(guide: Guide) -> None:
    points = fiducials_in_guide(guide)
    assert list(points) == [
        *(f"{ring}_{end}" for ring in ("small", "big") for end in ("centre", "x_plus", "x_minus", "y_plus", "y_minus")),
        "line_start",
        "line_end",
    ]
    assert points["big_y_minus"].tolist() == [0.0, -30.0, -60.0]
    assert points["line_end"].tolist() == [66.0, 0.0, 0.0]
