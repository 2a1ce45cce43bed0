"""The error budget against what it must be by hand, and against draws of everything at once."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from vision.aim_error import AimErrors, aim_error
from vision.budget import Budget, ErrorSource, error_budget
from vision.budget_check import check_budget, check_sources
from vision.budget_conditions import Conditions, conditions_of, reference_conditions
from vision.devices import CArm, Guide
from vision.motion_agreement import MotionErrors
from vision.projection import View
from vision.registered import Registration

MOTION = MotionErrors(math.radians(0.02), 0.1, math.radians(0.05), 0.1)
STILL = MotionErrors(0.0, 0.0, 0.0, 0.0)
NO_ERRORS = AimErrors(np.zeros(2), np.zeros(6), np.zeros((2, 6)), np.zeros(2), 0.0)
PIXEL, DEPTH_MM = np.array([600.0, 480.0]), 80.0
ROUND_95 = math.sqrt(-2.0 * math.log(0.05))  # radius of a round plane Gaussian that holds 95 %, standard deviations
DRAWS, DRAWS_ALONE = 800, 150


@pytest.fixture
def on_intensifier(guide: Guide, intensifier: CArm) -> Conditions:
    """The reference view of an intensifier."""
    return reference_conditions(guide, intensifier, MOTION, 5.0)


@pytest.fixture
def error(vector_view: View, guide: Guide) -> Callable[[AimErrors], tuple[float, float]]:
    """Angle (rad) and position (mm) that errors leave in the view of docs/method.md."""

    def of(errors: AimErrors) -> tuple[float, float]:
        vectors = aim_error(vector_view, vector_view, errors, guide, PIXEL, DEPTH_MM)
        return float(np.linalg.norm(vectors[:3])), float(np.linalg.norm(vectors[3:]))

    return of


def test_without_errors_the_axis_holds_source_and_target(error: Callable[..., tuple[float, float]]) -> None:
    assert error(NO_ERRORS) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_an_arm_that_stops_beside_its_goal_misses_by_as_much(error: Callable[..., tuple[float, float]]) -> None:
    beside = replace(NO_ERRORS, arm=np.array([[0.0] * 6, [0.0, 0.0, 0.0, 0.3, 0.4, 0.0]]))
    assert error(beside) == pytest.approx((0.0, 0.5), abs=1e-9)


def test_a_bore_that_is_not_coaxial_tilts_the_needle_about_the_small_ring(
    error: Callable[..., tuple[float, float]], guide: Guide
) -> None:
    tilt_rad = math.atan(0.05 / guide.separation_mm)
    angle_rad, position_mm = error(replace(NO_ERRORS, bore_mm=np.array([0.05, 0.0])))
    assert angle_rad == pytest.approx(tilt_rad)
    assert position_mm == pytest.approx((guide.separation_mm + DEPTH_MM) * math.sin(tilt_rad))


def test_a_wrong_calibration_harms_only_where_the_guide_turns(
    vector_view: View, guide: Guide, error: Callable[..., tuple[float, float]]
) -> None:
    wrong = replace(NO_ERRORS, tcp=np.array([0.0, 0.0, 0.0, 0.4, 0.0, 0.0]))
    angle_rad, position_mm = error(wrong)
    assert angle_rad == pytest.approx(0.0, abs=1e-12)
    assert 0.0 < position_mm < 0.4 * math.radians(12.0)
    straight = vector_view.source_from_guide.copy()
    straight[:3, :3], straight[:3, 3] = np.eye(3), (0.0, 0.0, 750.0)
    view = replace(vector_view, source_from_guide=straight)
    centre = np.array([view.intrinsics.u0_px, view.intrinsics.v0_px])
    assert aim_error(view, view, wrong, guide, centre, DEPTH_MM) == pytest.approx(np.zeros(6), abs=1e-9)


def shares(budget: Budget) -> dict[ErrorSource, float]:
    """Each source's share of the angle's variance."""
    return {source: budget.share(source).angle_share for source in ErrorSource}


def test_the_shares_make_up_the_whole(on_intensifier: Conditions) -> None:
    budget = error_budget(on_intensifier)
    assert sum(shares(budget).values()) == pytest.approx(1.0)
    assert sum(budget.share(source).position_share for source in ErrorSource) == pytest.approx(1.0)
    assert min(np.linalg.eigvalsh(covariance).min() for covariance in budget.covariances.values()) > -1e-12


def test_the_bore_s_share_is_that_of_its_tolerance(on_intensifier: Conditions, guide: Guide) -> None:
    share = error_budget(on_intensifier).share(ErrorSource.BORE)
    tilt_sd_rad = guide.tolerance.bore_concentricity_sd_mm / guide.separation_mm
    assert share.angle_rad == pytest.approx(ROUND_95 * tilt_sd_rad, rel=1e-3)
    assert share.position_mm == pytest.approx(ROUND_95 * tilt_sd_rad * (guide.separation_mm + DEPTH_MM), rel=1e-3)


def test_what_has_no_error_has_no_share(on_intensifier: Conditions, guide: Guide, flat_panel: CArm) -> None:
    still = error_budget(replace(on_intensifier, motion=STILL, depth_sd_mm=0.0))
    for source in (ErrorSource.ARM, ErrorSource.TCP_CALIBRATION, ErrorSource.TARGET_DEPTH):
        assert still.share(source).position_mm == 0.0
    panel = error_budget(reference_conditions(guide, flat_panel, MOTION, 5.0))
    assert panel.share(ErrorSource.DISTORTION).angle_rad == 0.0
    assert error_budget(on_intensifier).share(ErrorSource.DISTORTION).angle_rad > 0.0


def test_noisier_pixels_and_wider_tolerances_take_a_greater_part(on_intensifier: Conditions, guide: Guide) -> None:
    before = shares(error_budget(on_intensifier))
    noisier = shares(error_budget(replace(on_intensifier, noise_px=3.0 * on_intensifier.noise_px)))
    assert noisier[ErrorSource.PIXEL_NOISE] > 2.0 * before[ErrorSource.PIXEL_NOISE]
    wide = replace(guide, tolerance=replace(guide.tolerance, radius_sd_mm=0.06))
    assert shares(error_budget(replace(on_intensifier, guide=wide)))[ErrorSource.RING_TOLERANCES] > (
        2.0 * before[ErrorSource.RING_TOLERANCES]
    )


def assert_agrees(conditions: Conditions) -> None:
    """Root mean squares and 95 % bounds within four standard deviations of the sample."""
    check = check_budget(conditions, error_budget(conditions), DRAWS, 3)
    assert check.angle_ratio == pytest.approx(1.0, abs=4.0 / math.sqrt(2.0 * DRAWS))
    assert check.position_ratio == pytest.approx(1.0, abs=4.0 / math.sqrt(2.0 * DRAWS))
    assert check.angle_within == pytest.approx(0.95, abs=4.0 * math.sqrt(0.95 * 0.05 / DRAWS))
    assert check.position_within == pytest.approx(0.95, abs=4.0 * math.sqrt(0.95 * 0.05 / DRAWS))


@pytest.mark.parametrize("kind", ["intensifier", "flat_panel"])
def test_draws_of_everything_at_once_agree_with_the_linear_total(
    kind: str, guide: Guide, request: pytest.FixtureRequest
) -> None:
    assert_agrees(reference_conditions(guide, request.getfixturevalue(kind), MOTION, 5.0))


@pytest.mark.parametrize("kind", ["intensifier", "flat_panel"])
def test_draws_of_what_the_registration_leaves_agree_with_its_own_part(
    kind: str, guide: Guide, request: pytest.FixtureRequest
) -> None:
    # a good bore and no arm hide nothing; a distance known to 5 mm, for with 30 mm its product with the tolerances,
    # which no linear propagation holds, adds a tenth to the angle
    good = replace(guide, tolerance=replace(guide.tolerance, bore_concentricity_sd_mm=0.005))
    carm = replace(request.getfixturevalue(kind), source_to_image_sd_mm=5.0)
    assert_agrees(reference_conditions(good, carm, STILL, 5.0))


def test_draws_of_each_source_alone_agree_with_its_own_part(on_intensifier: Conditions) -> None:
    # 15 px of the principal point leave a third more of the angle than to first order
    carm = replace(on_intensifier.carm, source_to_image_sd_mm=5.0, principal_point_sd_px=3.0)
    conditions = replace(on_intensifier, carm=carm)
    checks = check_sources(conditions, error_budget(conditions), DRAWS_ALONE, 5)
    assert set(checks) == set(ErrorSource) - {ErrorSource.TARGET_DEPTH}
    for check in checks.values():
        assert check.angle_ratio == pytest.approx(1.0, abs=4.0 / math.sqrt(2.0 * DRAWS_ALONE))
        assert check.position_ratio == pytest.approx(1.0, abs=4.0 / math.sqrt(2.0 * DRAWS_ALONE))


def test_a_source_that_does_nothing_has_no_ratio(on_intensifier: Conditions) -> None:
    still = replace(on_intensifier, motion=STILL)
    check = check_sources(still, error_budget(still), 2, 5)[ErrorSource.ARM]
    assert (check.angle_ratio, check.position_ratio) == (None, None)


def test_a_registration_of_another_detector_is_no_condition(
    make_registration: Callable[..., Registration], vector_view: View, guide: Guide, intensifier: CArm
) -> None:
    with pytest.raises(ValueError, match="another kind of detector"):
        conditions_of(make_registration(vector_view), guide, intensifier, MOTION, 5.0)
