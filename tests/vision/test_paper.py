from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from vision.alignment import goal, ray_in_source
from vision.devices import Guide, GuideTolerance
from vision.paper import PaperSolution, solve
from vision.projection import View, fiducials_in_guide, project
from vision.refusal import Refusal, RefusalCode


def pixels_of(view: View, guide: Guide) -> dict[str, np.ndarray]:
    """The exact fiducials."""
    names, points = zip(*fiducials_in_guide(guide).items(), strict=True)
    return dict(zip(names, project(view, np.array(points)), strict=True))


def angle_error_deg(truth: View, solution: PaperSolution, pixel: np.ndarray) -> float:
    """Angle between the true ray and the guide's true axis after the move that `solution` commands."""
    guide_from_goal, _ = goal(solution.view, pixel)
    axis = truth.source_from_guide[:3, :3] @ guide_from_goal[:3, 2]
    return float(np.degrees(np.linalg.norm(np.cross(axis, ray_in_source(truth.intrinsics, pixel)))))


@given(
    st.floats(0.0, 40.0),
    st.floats(0.0, 360.0),
    st.floats(0.0, 360.0),
    st.tuples(st.floats(-60.0, 60.0), st.floats(-60.0, 60.0), st.floats(600.0, 900.0)),
)
def test_projected_then_solved_gives_the_view_back(
    make_view: Callable[..., View],
    guide: Guide,
    tilt_deg: float,
    azimuth_deg: float,
    roll_deg: float,
    translation_mm: tuple[float, float, float],
) -> None:
    view = make_view(tilt_deg, azimuth_deg, roll_deg, translation_mm, centre_px=(520.0, 503.0), alpha_px=2900.0)
    solution = solve(pixels_of(view, guide), guide)
    assert isinstance(solution, PaperSolution)
    found, expected = solution.view, view
    # px and mm: rounding only, through a condition number of some 1e5
    assert found.intrinsics.alpha_x_px == pytest.approx(expected.intrinsics.alpha_x_px, abs=1e-4)
    assert found.intrinsics.v0_px == pytest.approx(expected.intrinsics.v0_px, abs=1e-4)
    assert found.source_from_guide == pytest.approx(expected.source_from_guide, abs=1e-4)
    assert solution.residual_rms_px < 1e-6


def test_pose_is_rigid_with_noise(vector_view: View, guide: Guide) -> None:
    rng = np.random.default_rng(3)
    noisy = {name: pixel + rng.normal(0.0, 0.3, 2) for name, pixel in pixels_of(vector_view, guide).items()}
    solution = solve(noisy, guide)
    assert isinstance(solution, PaperSolution)
    rotation = solution.view.source_from_guide[:3, :3]
    assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    assert solution.residual_rms_px == pytest.approx(
        0.3 * np.sqrt(13.0 / 12.0), abs=0.15
    )  # px, 13 of 24 degrees of freedom are left


def test_aim_reaches_the_bound_of_twelve_noisy_points(make_view: Callable[..., View], guide: Guide) -> None:
    rng = np.random.default_rng(5)
    errors_deg = []
    for _ in range(60):
        view = make_view(rng.uniform(5.0, 25.0), rng.uniform(0.0, 360.0), rng.uniform(0.0, 360.0))
        noisy = {name: pixel + rng.normal(0.0, 0.3, 2) for name, pixel in pixels_of(view, guide).items()}
        solution = solve(noisy, guide)
        assert isinstance(solution, PaperSolution)
        errors_deg.append(angle_error_deg(view, solution, rng.uniform(400.0, 620.0, 2)))
    # deg RMS; the Cramer-Rao bound for 12 points at 0.3 px is 0.085 (docs/method.md), and 60 draws scatter by 10 %
    assert np.sqrt(np.mean(np.square(errors_deg))) < 0.13


def test_covariance_matches_the_scatter_of_the_solution(vector_view: View, guide: Guide) -> None:
    rng = np.random.default_rng(7)
    exact = pixels_of(vector_view, guide)
    guide = replace(guide, tolerance=GuideTolerance(0.005, 0.005, 0.05, 0.02))  # the draws below have none
    tilts, predicted = [], []
    for _ in range(150):
        solution = solve({name: pixel + rng.normal(0.0, 0.1, 2) for name, pixel in exact.items()}, guide)
        assert isinstance(solution, PaperSolution)
        turned = solution.view.source_from_guide[:3, :3] @ vector_view.source_from_guide[:3, :3].T
        tilts.append(Rotation.from_matrix(turned).as_rotvec()[:2])
        predicted.append(np.diag(solution.covariance)[4:6])
    ratio = np.mean(np.square(tilts), axis=0) / np.mean(predicted, axis=0)
    assert ratio == pytest.approx(1.0, abs=0.35)  # 150 draws scatter a variance by 12 %, 3 sd of that


def test_turned_image_gives_the_turned_pose(vector_view: View, guide: Guide) -> None:
    turned = {name: np.array([1023.0 - v, u]) for name, (u, v) in pixels_of(vector_view, guide).items()}
    solution = solve(turned, guide)
    assert isinstance(solution, PaperSolution)
    expected = Rotation.from_euler("z", 90.0, degrees=True).as_matrix() @ vector_view.source_from_guide[:3, :3]
    assert solution.view.source_from_guide[:3, :3] == pytest.approx(expected, abs=1e-6)


def test_points_on_a_line_are_refused(guide: Guide) -> None:
    names = list(fiducials_in_guide(guide))
    refusal = solve({name: np.array([100.0 + i, 100.0]) for i, name in enumerate(names)}, guide)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.GUIDE_MISMATCH
