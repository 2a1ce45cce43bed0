from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from vision.alignment import angle_vector, goal, position_vector, ray_in_source, target_in_source
from vision.devices import Guide, GuideTolerance
from vision.paper import PaperSolution, solve
from vision.projection import Intrinsics, View, fiducials_in_guide, project
from vision.uncertainty import alignment_bounds, predicted_error, radius_95

DEPTH_MM = 80.0
PIXEL = np.array([600.0, 480.0])


def true_errors(truth: View, guide: Guide, guide_from_axis: np.ndarray, pixel: np.ndarray) -> tuple[float, float]:
    """Angle (rad) and distance (mm) of an axis from the target, were `truth` the view."""
    source_from_axis = truth.source_from_guide @ guide_from_axis
    axis, ray = source_from_axis[:3, 2], ray_in_source(truth.intrinsics, pixel)
    target = target_in_source(truth, pixel, guide, DEPTH_MM)
    angle = np.linalg.norm(angle_vector(axis, ray))
    return float(angle), float(np.linalg.norm(position_vector(source_from_axis[:3, 3], axis, target)))


def with_bore_tilt(guide_from_goal: np.ndarray, guide: Guide, offset_mm: np.ndarray) -> np.ndarray:
    """The sleeve's axis when the bore is off by `offset_mm` (2,) at the big ring."""
    tilted = guide_from_goal.copy()
    turn = [offset_mm[1] / guide.separation_mm, -offset_mm[0] / guide.separation_mm, 0.0]
    tilted[:3, :3] = tilted[:3, :3] @ Rotation.from_rotvec(turn).as_matrix()
    return tilted


def test_factor_runs_from_round_to_thin() -> None:
    assert radius_95(np.eye(2)) / np.sqrt(2.0) == pytest.approx(1.7308, abs=1e-3)  # sqrt(5.9915 / 2)
    assert radius_95(np.diag([1.0, 0.0])) == pytest.approx(1.95996, abs=2e-3)  # the normal's own quantile
    assert radius_95(np.zeros((3, 3))) == 0.0


@given(st.floats(0.0, 1.0), st.floats(1e-8, 1e4), st.floats(0.0, np.pi))
def test_radius_holds_95_percent_at_every_thinness(thinness: float, scale: float, angle_rad: float) -> None:
    cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    covariance = turn @ np.diag([1.0, thinness]) @ turn.T * scale
    draws = np.random.default_rng(11).standard_normal((4000, 2)) @ np.diag([1.0, np.sqrt(thinness)]) @ turn.T
    inside = np.linalg.norm(draws * np.sqrt(scale), axis=1) <= radius_95(covariance)
    assert inside.mean() == pytest.approx(0.95, abs=0.012)  # 4000 draws scatter by 0.0035


def test_bore_offset_of_the_method_gives_its_numbers(vector_view: View, guide: Guide) -> None:
    # docs/method.md: 0.05 mm are 0.048 deg and 0.12 mm; the bound is that times the round factor
    tolerance = GuideTolerance(0.02, 0.03, 0.05, bore_concentricity_sd_mm=0.05)
    bounds = predicted_error(vector_view, np.zeros((10, 10)), replace(guide, tolerance=tolerance), PIXEL, DEPTH_MM)
    round_factor = np.sqrt(5.9915)
    assert np.degrees(bounds.angle_rad) == pytest.approx(0.0477 * round_factor, abs=2e-4)
    assert bounds.position_mm == pytest.approx(0.1167 * round_factor, abs=1e-3)


def test_rotation_about_the_source_costs_nothing(vector_view: View, guide: Guide) -> None:
    """Tilt against principal point: what intrinsics and pose trade must not widen the bounds (docs/method.md)."""
    alpha_px = vector_view.intrinsics.alpha_x_px
    pose = vector_view.source_from_guide
    lever = Rotation.from_rotvec([0.0, 1e-6, 0.0]).as_matrix() @ pose[:3, 3] - pose[:3, 3]
    # a turn by w about v moves the image by -alpha w near its centre; u0 takes it back
    trade = np.concatenate(([0.0, 0.0, -alpha_px, 0.0], [0.0, 1.0, 0.0], lever / 1e-6))
    sd_rad = 3e-3
    bounds = predicted_error(vector_view, np.outer(trade, trade) * sd_rad**2, guide, PIXEL, DEPTH_MM)
    bore = predicted_error(vector_view, np.zeros((10, 10)), guide, PIXEL, DEPTH_MM)
    assert bounds.angle_rad - bore.angle_rad < 0.05 * sd_rad


def test_bounds_hold_for_draws_from_the_covariance(vector_view: View, guide: Guide) -> None:
    exact = dict(
        zip(
            fiducials_in_guide(guide),
            project(vector_view, np.array(list(fiducials_in_guide(guide).values()))),
            strict=True,
        )
    )
    solution = solve(exact, guide)
    assert isinstance(solution, PaperSolution)
    bounds = predicted_error(vector_view, solution.covariance, guide, PIXEL, DEPTH_MM)
    guide_from_goal, _ = goal(vector_view, PIXEL)
    rng = np.random.default_rng(13)
    inside = np.zeros(2)
    draws = 1500
    for step in rng.multivariate_normal(np.zeros(10), solution.covariance, size=draws, method="eigh"):
        intrinsics = vector_view.intrinsics
        truth = View(
            Intrinsics(
                intrinsics.alpha_x_px + step[0],
                intrinsics.alpha_y_px + step[1],
                intrinsics.u0_px + step[2],
                intrinsics.v0_px + step[3],
            ),
            vector_view.source_from_guide.copy(),
        )
        truth.source_from_guide[:3, :3] = (
            Rotation.from_rotvec(step[4:7]).as_matrix() @ vector_view.source_from_guide[:3, :3]
        )
        truth.source_from_guide[:3, 3] += step[7:]
        sleeve = with_bore_tilt(guide_from_goal, guide, rng.normal(0.0, 0.02, 2))
        angle_rad, position_mm = true_errors(truth, guide, sleeve, PIXEL)
        inside += (angle_rad <= bounds.angle_rad, position_mm <= bounds.position_mm)
    # 1500 draws scatter by 0.006; the covariance is large enough to bend the linear propagation a little
    assert inside / draws == pytest.approx((0.95, 0.95), abs=0.02)


def test_bounds_hold_from_noisy_pixels_and_an_imperfect_guide(make_view: Callable[..., View], guide: Guide) -> None:
    rng = np.random.default_rng(17)
    inside, trials = np.zeros(2), 150
    for _ in range(trials):
        view = make_view(rng.uniform(0.0, 30.0), rng.uniform(0.0, 360.0), rng.uniform(0.0, 360.0))
        made = replace(
            guide,
            small_ring_radius_mm=20.0 + rng.normal(0.0, 0.02),
            big_ring_radius_mm=30.0 + rng.normal(0.0, 0.02),
            separation_mm=60.0 + rng.normal(0.0, 0.03),
        )
        pixels = project(view, np.array(list(fiducials_in_guide(made).values()))) + rng.normal(0.0, 0.1, (12, 2))
        solution = solve(dict(zip(fiducials_in_guide(guide), pixels, strict=True)), guide)
        assert isinstance(solution, PaperSolution)
        target_px = rng.uniform(400.0, 620.0, 2)
        bounds = predicted_error(solution.view, solution.covariance, guide, target_px, DEPTH_MM)
        guide_from_goal, _ = goal(solution.view, target_px)
        sleeve = with_bore_tilt(guide_from_goal, guide, rng.normal(0.0, 0.02, 2))
        angle_rad, position_mm = true_errors(view, made, sleeve, target_px)
        inside += (angle_rad <= bounds.angle_rad, position_mm <= bounds.position_mm)
    # 150 trials scatter by 0.018, and each estimates its noise from 13 degrees of freedom
    assert (inside / trials >= 0.89).all()
    assert (inside / trials <= 0.995).all()


def test_bounds_of_a_seen_axis_do_not_depend_on_where_it_points(vector_view: View, guide: Guide) -> None:
    covariance = np.diag([1.0] * 4 + [1e-8] * 3 + [1e-4] * 3)
    seen = alignment_bounds(vector_view, covariance, guide, PIXEL, DEPTH_MM, np.eye(4))
    aimed = predicted_error(vector_view, covariance, guide, PIXEL, DEPTH_MM)
    assert seen.angle_rad == pytest.approx(aimed.angle_rad, rel=0.05)
    assert seen.position_mm == pytest.approx(aimed.position_mm, rel=0.5)
