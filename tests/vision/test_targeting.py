import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from vision.alignment import ray_in_source
from vision.devices import CArm
from vision.projection import View
from vision.refusal import Refusal, RefusalCode
from vision.registered import PixelSpace, Registration
from vision.targeting import Targeting, target

PRINTED = 5e-7  # half a unit of the last printed digit of the test vector, mm and deg

tilts_deg = st.floats(0.0, 40.0)
turns_deg = st.floats(0.0, 360.0)
pixels = st.tuples(st.floats(200.0, 820.0), st.floats(200.0, 820.0))


def aimed(result: Targeting | Refusal) -> Targeting:
    """The targeting, where none may be refused."""
    assert isinstance(result, Targeting), result
    return result


def test_goal_of_the_test_vector(vector_view: View, make_registration: Callable[..., Registration]) -> None:
    targeting = aimed(target(make_registration(vector_view), (600.0, 480.0), PixelSpace.CORRECTED))
    assert targeting.translation_mm == pytest.approx((13.324837, -3.308398, 0.252955), abs=PRINTED)
    rotation_vector_deg = np.degrees(targeting.rotation_axis * targeting.rotation_rad)
    assert rotation_vector_deg == pytest.approx((-9.362489, 1.789934, 0.0), abs=PRINTED)
    assert targeting.guide_from_goal[:3, :3] == pytest.approx(
        Rotation.from_rotvec(rotation_vector_deg, degrees=True).as_matrix(), abs=1e-12
    )


@given(tilts_deg, turns_deg, turns_deg, pixels)
def test_goal_axis_goes_through_source_and_target(
    make_view: Callable[..., View],
    make_registration: Callable[..., Registration],
    tilt_deg: float,
    azimuth_deg: float,
    roll_deg: float,
    pixel: tuple[float, float],
) -> None:
    view = make_view(tilt_deg, azimuth_deg, roll_deg)
    targeting = aimed(target(make_registration(view), pixel, PixelSpace.CORRECTED))
    source_from_goal = view.source_from_guide @ targeting.guide_from_goal
    ray = ray_in_source(view.intrinsics, np.array(pixel))
    assert source_from_goal[:3, 2] == pytest.approx(ray, abs=1e-9)
    # mm: the source is the origin, and the small ring keeps its distance from it (3)
    assert source_from_goal[:3, 3] == pytest.approx(ray * np.linalg.norm(view.source_from_guide[:3, 3]), abs=1e-9)


@given(tilts_deg, turns_deg, pixels, st.floats(-180.0, 180.0))
def test_rotation_is_the_least_that_aligns(
    make_view: Callable[..., View],
    make_registration: Callable[..., Registration],
    tilt_deg: float,
    azimuth_deg: float,
    pixel: tuple[float, float],
    spin_deg: float,
) -> None:
    assume(abs(spin_deg) > 0.1)
    targeting = aimed(target(make_registration(make_view(tilt_deg, azimuth_deg)), pixel, PixelSpace.CORRECTED))
    spun = Rotation.from_matrix(targeting.guide_from_goal[:3, :3]) * Rotation.from_euler("z", spin_deg, degrees=True)
    assert spun.magnitude() > targeting.rotation_rad
    assert targeting.rotation_axis[2] == pytest.approx(0.0, abs=1e-12)  # no spin about the guide's own axis


@given(tilts_deg, turns_deg, turns_deg, pixels, st.sampled_from([90.0, 180.0, 270.0]))
def test_move_does_not_depend_on_how_the_image_is_turned(
    make_view: Callable[..., View],
    make_registration: Callable[..., Registration],
    tilt_deg: float,
    azimuth_deg: float,
    roll_deg: float,
    pixel: tuple[float, float],
    turn_deg: float,
) -> None:
    view = make_view(tilt_deg, azimuth_deg, roll_deg)
    turn = Rotation.from_euler("z", turn_deg, degrees=True).as_matrix()
    pose = np.eye(4)
    pose[:3] = turn @ view.source_from_guide[:3]
    u, v = turn[:2, :2] @ (np.array(pixel) - 511.5) + 511.5
    before = aimed(target(make_registration(view), pixel, PixelSpace.CORRECTED))
    after = aimed(target(make_registration(View(view.intrinsics, pose)), (u, v), PixelSpace.CORRECTED))
    assert after.guide_from_goal == pytest.approx(before.guide_from_goal, abs=1e-9)


def test_aligned_guide_needs_no_rotation(
    make_view: Callable[..., View], make_registration: Callable[..., Registration]
) -> None:
    view = make_view(0.0, translation_mm=(0.0, 0.0, 750.0))
    targeting = aimed(target(make_registration(view), (511.5, 511.5), PixelSpace.CORRECTED))
    assert targeting.rotation_rad == 0.0
    assert targeting.guide_from_goal == pytest.approx(np.eye(4), abs=1e-12)
    assert np.linalg.norm(targeting.rotation_axis) == 1.0


def test_tiny_rotation_keeps_its_digits(
    make_view: Callable[..., View], make_registration: Callable[..., Registration]
) -> None:
    view = make_view(math.degrees(1e-9), translation_mm=(0.0, 0.0, 750.0))
    targeting = aimed(target(make_registration(view), (511.5, 511.5), PixelSpace.CORRECTED))
    assert targeting.rotation_rad == pytest.approx(1e-9, rel=1e-6)  # an arccos would give 0


@pytest.mark.hazard("H08")
def test_raw_pixel_is_corrected_and_a_corrected_one_is_not(
    vector_view: View, make_registration: Callable[..., Registration]
) -> None:
    registration = make_registration(vector_view, shift_px=(3.0, -7.0))
    raw = aimed(target(registration, (597.0, 487.0), PixelSpace.RAW))
    corrected = aimed(target(registration, (600.0, 480.0), PixelSpace.CORRECTED))
    assert raw.target_corrected_px.tolist() == [600.0, 480.0]
    assert corrected.target_raw_px.tolist() == [597.0, 487.0]
    assert raw.guide_from_goal.tolist() == corrected.guide_from_goal.tolist()


@pytest.mark.parametrize("pixel", [(math.nan, 480.0), (600.0, math.inf), (-math.inf, math.nan)])
@pytest.mark.parametrize("space", list(PixelSpace))
def test_target_that_is_no_number_is_refused(
    vector_view: View, make_registration: Callable[..., Registration], pixel: tuple[float, float], space: PixelSpace
) -> None:
    refusal = target(make_registration(vector_view), pixel, space)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.TARGET_NOT_FINITE


@pytest.mark.hazard("H08")
@pytest.mark.parametrize(
    ("pixel", "beyond_px"), [((-0.6, 480.0), 0.1), ((1023.6, 480.0), 0.1), ((500.0, -8.0), 7.5), ((500.0, 1e9), 1e9)]
)
@pytest.mark.parametrize("space", list(PixelSpace))
def test_target_outside_the_image_is_refused_with_the_distance(
    vector_view: View,
    make_registration: Callable[..., Registration],
    pixel: tuple[float, float],
    beyond_px: float,
    space: PixelSpace,
) -> None:
    refusal = target(make_registration(vector_view), pixel, space)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.TARGET_OUTSIDE_IMAGE
    assert refusal.measured == pytest.approx(beyond_px, rel=1e-5)


def test_corner_is_in_the_image_of_a_flat_panel_only(
    vector_view: View, make_registration: Callable[..., Registration], intensifier: CArm
) -> None:
    assert isinstance(target(make_registration(vector_view), (2.0, 2.0), PixelSpace.RAW), Targeting)
    refusal = target(make_registration(vector_view, carm=intensifier), (2.0, 2.0), PixelSpace.RAW)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.TARGET_OUTSIDE_IMAGE


def test_outside_is_judged_in_the_raw_image(vector_view: View, make_registration: Callable[..., Registration]) -> None:
    registration = make_registration(vector_view, shift_px=(20.0, 0.0))
    assert isinstance(target(registration, (1030.0, 500.0), PixelSpace.CORRECTED), Targeting)
    assert isinstance(target(registration, (10.0, 500.0), PixelSpace.CORRECTED), Refusal)


@pytest.mark.parametrize("depth_mm", [0.08, 0.0, -80.0, 80_000.0, 690.0])
def test_implausible_depth_is_refused(
    vector_view: View, make_registration: Callable[..., Registration], depth_mm: float
) -> None:
    refusal = target(make_registration(vector_view), (600.0, 480.0), PixelSpace.RAW, depth_mm)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.TARGET_NOT_REACHABLE
    assert refusal.measured == depth_mm


def test_depth_that_is_no_number_is_refused(vector_view: View, make_registration: Callable[..., Registration]) -> None:
    refusal = target(make_registration(vector_view), (600.0, 480.0), PixelSpace.RAW, math.nan)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.TARGET_NOT_FINITE


def test_depth_that_reaches_the_source_is_refused(
    make_view: Callable[..., View], make_registration: Callable[..., Registration]
) -> None:
    registration = make_registration(make_view(10.0, translation_mm=(0.0, 0.0, 300.0)))
    assert isinstance(target(registration, (600.0, 480.0), PixelSpace.RAW, 200.0), Targeting)
    assert isinstance(target(registration, (600.0, 480.0), PixelSpace.RAW, 240.0), Refusal)


def test_guide_that_points_at_the_source_is_refused(
    vector_view: View, make_registration: Callable[..., Registration]
) -> None:
    backwards = vector_view.source_from_guide.copy()
    backwards[:3, :3] = backwards[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    registration = replace(make_registration(vector_view), source_from_guide=backwards)
    refusal = target(registration, (600.0, 480.0), PixelSpace.RAW)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.TARGET_NOT_REACHABLE


def test_deeper_target_has_the_same_move_and_a_wider_bound(
    vector_view: View, make_registration: Callable[..., Registration]
) -> None:
    registration = make_registration(vector_view)
    near = aimed(target(registration, (600.0, 480.0), PixelSpace.RAW, 40.0))
    far = aimed(target(registration, (600.0, 480.0), PixelSpace.RAW, 160.0))
    assert near.guide_from_goal.tolist() == far.guide_from_goal.tolist()
    assert far.predicted_error_95.position_mm > near.predicted_error_95.position_mm
    assert far.predicted_error_95.depth_mm == 160.0


def test_a_target_where_the_aim_may_be_wrong_is_refused(
    vector_view: View, make_registration: Callable[..., Registration]
) -> None:
    sure = make_registration(vector_view)
    near, far = (511.5, 511.5), (60.0, 60.0)
    doubtful = next(
        unsure
        for factor in np.geomspace(1.0, 1e8, 100)
        if isinstance(
            target(unsure := replace(sure, covariance=sure.covariance * factor), far, PixelSpace.RAW), Refusal
        )
    )
    refusal = target(doubtful, far, PixelSpace.RAW)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.PREDICTED_ERROR_TOO_HIGH
    assert isinstance(target(doubtful, near, PixelSpace.RAW), Targeting)
