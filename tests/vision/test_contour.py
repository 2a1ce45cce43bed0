"""The contour fit on exact and noisy ridge points: what it recovers, and whether its covariance is true."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision import contour, view_fit
from vision.contour import ContourFit, fit_contour
from vision.devices import CArm, Guide
from vision.distortion import DistortionMap, exact
from vision.priors import Priors
from vision.projection import Intrinsics, View, nominal_intrinsics, project
from vision.view_fit import Observations
from vision.wire_model import sample_wires, with_dimensions

Array = NDArray[np.float64]

FLAT = exact(DistortionMap.identity(1024, 1024, 360.0 / 1024.0))
PLACE_MM = (12.0, -7.0, 748.0)


def observed(view: View, guide: Guide, noise_px: float, seed: int, outliers: float = 0.0) -> Observations:
    """Every second place on the wires with independent noise; a share of them far off."""
    rng = np.random.default_rng(seed)
    samples = sample_wires(view, guide)
    samples = samples.chosen(np.arange(len(samples.along)) % 2 == 0)
    off_px = rng.normal(0.0, noise_px, len(samples.along))
    off_px += np.where(rng.uniform(size=len(off_px)) < outliers, rng.uniform(1.0, 5.0, len(off_px)), 0.0)
    measured = samples.points + off_px[:, None] * samples.normals
    none = np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0)
    return Observations(samples.wire, samples.along, measured, samples.normals, np.zeros(len(samples.along)), *none)


def near(view: View, carm: CArm) -> View:
    """Where a fit may start: nominal intrinsics and a pose half a degree and some mm off."""
    pose = view.source_from_guide.copy()
    pose[:3, :3] = Rotation.from_rotvec([0.008, -0.006, 0.01]).as_matrix() @ pose[:3, :3]
    pose[:3, 3] += (1.0, -0.8, 6.0)
    return View(nominal_intrinsics(carm, 1024, 1024), pose)


@pytest.fixture
def priors(flat_panel: CArm, guide: Guide) -> Priors:
    """Of the reference devices."""
    return Priors.of(flat_panel, guide, nominal_intrinsics(flat_panel, 1024, 1024))


@pytest.fixture
def solve(guide: Guide, flat_panel: CArm, priors: Priors) -> Callable[..., ContourFit]:
    """Fits from nearby, with the reference files."""

    def fit(view: View, observations: Observations) -> ContourFit:
        return fit_contour(near(view, flat_panel), guide, observations, priors, FLAT)

    return fit


def axis_error(view: View, truth: View) -> Array:
    """What targeting lives on (4,), px: the images of two points of the guide's axis, far below and at the TCP."""
    points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -140.0]])
    return (project(view, points) - project(truth, points)).ravel()


@pytest.mark.parametrize("tilt_deg", [0.0, 10.0, 30.0])
def test_exact_points_give_the_exact_axis(
    tilt_deg: float, make_view: Callable[..., View], guide: Guide, solve: Callable[..., ContourFit]
) -> None:
    truth = make_view(tilt_deg, 40.0, 70.0, PLACE_MM)
    fit = solve(truth, observed(truth, guide, 0.0, 1))
    # truth has nominal intrinsics: priors do not pull; only pixels of 1e-2 are asked of the iteration
    assert np.abs(axis_error(fit.view, truth)).max() < 0.02
    assert max(map(abs, fit.pulls_sd.values())) < 0.1


def test_a_fifth_of_far_off_points_moves_nothing(
    make_view: Callable[..., View], guide: Guide, solve: Callable[..., ContourFit]
) -> None:
    truth = make_view(12.0, 100.0, 200.0, PLACE_MM)
    clean = solve(truth, observed(truth, guide, 0.1, 2))
    dirty = solve(truth, observed(truth, guide, 0.1, 2, outliers=0.2))
    assert dirty.noise_px < 0.2
    # 1,000 points of 0.1 px place the axis within some 0.1 px 140 mm away; a bias of the outliers would be 0.5 px
    assert np.abs(axis_error(dirty.view, truth)).max() < 2.0 * np.abs(axis_error(clean.view, truth)).max() + 0.2


def test_a_fit_that_goes_on_from_known_weights_ends_where_the_first_did(
    make_view: Callable[..., View],
    guide: Guide,
    priors: Priors,
    solve: Callable[..., ContourFit],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    truth = make_view(12.0, 100.0, 200.0, PLACE_MM)
    observations = observed(truth, guide, 0.1, 2, outliers=0.2)
    fit = solve(truth, observations)
    for _ in range(3):  # until the weights no longer change
        fit = fit_contour(fit.view, fit.guide, observations, priors, FLAT, fit)
    monkeypatch.setattr(contour, "_LATER_REWEIGHTINGS", 1)
    again = fit_contour(fit.view, fit.guide, observations, priors, FLAT, fit)
    assert np.abs(axis_error(again.view, fit.view)).max() < 0.01  # px; noise moves it by a tenth, outliers by half


def test_the_covariance_covers_the_errors(
    make_view: Callable[..., View], guide: Guide, solve: Callable[..., ContourFit]
) -> None:
    truth = make_view(15.0, 60.0, 10.0, PLACE_MM)
    squares = []
    for seed in range(25):
        fit = solve(truth, observed(truth, guide, 0.15, 100 + seed))
        step = np.concatenate(
            (
                [
                    fit.view.intrinsics.u0_px - truth.intrinsics.u0_px,
                    fit.view.intrinsics.v0_px - truth.intrinsics.v0_px,
                ],
                fit.view.source_from_guide[:3, 3] - truth.source_from_guide[:3, 3],
            )
        )
        index = [2, 3, 7, 8, 9]
        squares.append(step**2 / np.diag(fit.covariance)[index])
    # the map's and the ground's unmodelled share is in it too, so the errors here are smaller than predicted
    assert np.mean(squares) < 1.3
    assert np.mean(squares) > 0.005


def test_correlated_noise_widens_the_covariance(
    make_view: Callable[..., View], guide: Guide, solve: Callable[..., ContourFit]
) -> None:
    truth = make_view(10.0, 0.0, 0.0, PLACE_MM)
    white = observed(truth, guide, 0.3, 5)
    noise = np.random.default_rng(6).normal(0.0, 0.3, len(white.along) + 4)
    smooth = np.convolve(noise, np.full(5, 5.0**-0.5), mode="valid")
    exact_points = observed(truth, guide, 0.0, 5)
    coloured = replace(exact_points, measured=exact_points.measured + smooth[:, None] * exact_points.normals)
    one, other = solve(truth, white), solve(truth, coloured)
    # what the image tells of the position when all else is known: the principal point's prior does not hide it
    assert np.linalg.inv(other.covariance)[7, 7] < 0.5 * np.linalg.inv(one.covariance)[7, 7]


@pytest.mark.parametrize(
    ("changes", "strained"),
    [((1.03, 1.0, 1.0), 4.0), ((1.0, 1.05, 1.0), 4.0), ((1.0, 1.0, 1.1), 1.5)],
    ids=["small radius", "big radius", "separation"],
)
def test_a_wrong_dimension_strains_the_priors(
    changes: tuple[float, float, float],
    strained: float,
    make_view: Callable[..., View],
    guide: Guide,
    solve: Callable[..., ContourFit],
) -> None:
    small, big, apart = changes
    made = with_dimensions(guide, 20.0 * small, 30.0 * big, 60.0 * apart)
    truth = make_view(12.0, 30.0, 0.0, PLACE_MM)
    fit = solve(truth, observed(truth, made, 0.1, 7))
    assert max(map(abs, fit.pulls_sd.values())) > strained


def test_priors_tell_each_quantity_in_its_own_deviations(priors: Priors, guide: Guide) -> None:
    nominal = priors.nominal
    view = View(
        Intrinsics(nominal.alpha_x_px * 1.03, nominal.alpha_y_px * 1.03, nominal.u0_px + 15.0, nominal.v0_px - 30.0),
        np.eye(4),
    )
    pulls = priors.pulls(view, with_dimensions(guide, 20.04, 30.0, 59.97))
    expected = {
        "source_to_image": 1.0,
        "square": 0.0,
        "centre_u": 1.0,
        "centre_v": -2.0,
        "small_radius": 2.0,
        "big_radius": 0.0,
        "separation": -1.0,
    }
    assert pulls == pytest.approx(expected, abs=1e-6)


def test_the_design_is_the_derivative_of_the_residuals(
    make_view: Callable[..., View], guide: Guide, priors: Priors
) -> None:
    view = make_view(25.0, 70.0, 130.0, PLACE_MM)
    points = replace(
        observed(view, guide, 0.3, 8),
        extra_in_guide=np.array([[0.0, 45.0, -30.0], [66.0, 0.0, 0.0]]),
        extra_measured=np.array([[500.0, 610.0], [420.0, 333.0]]),
        extra_normals=np.array([[1.0, 0.0], [0.6, 0.8]]),
        extra_sd_px=np.array([0.2, 0.6]),
    )
    places = view_fit.Places.of(points)

    def residual(step: Array) -> Array:
        moved = view_fit._moved(view, guide, step)
        return np.concatenate((places.residual_px(*moved), places.others(*moved, priors)))

    steps = 1e-3 * np.diag(view_fit._SCALES)
    numeric = np.column_stack([(residual(step) - residual(-step)) / (2.0 * step.max()) for step in steps])
    design = np.vstack((places.design(view, guide), places.others_design(view, priors)))
    assert np.abs(design - numeric).max(axis=0) == pytest.approx(0.0, abs=1e-6 * np.abs(numeric).max())
