"""The shadows' profiles, the nearest places on a wire, and the noise of neighbours."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from vision.devices import Guide
from vision.projection import View
from vision.wire_model import Wire, feet, sample_wires
from vision.wire_noise import LEAST_NOISE_PX, Neighbours, PlaceCovariance, WireNoise
from vision.wire_shape import ball_profile, wire_profile

Array = NDArray[np.float64]


def test_a_profile_is_even_and_its_slope_is_its_derivative() -> None:
    profile = wire_profile(2.3, 0.8, 1.1)
    x = np.linspace(-6.0, 6.0, 97)
    assert profile.heights(np.zeros(1)) == pytest.approx([1.0])
    assert profile.heights(x) == pytest.approx(profile.heights(-x))
    numeric = (profile.heights(x + 0.05) - profile.heights(x - 0.05)) / 0.1
    assert profile.slopes(x) == pytest.approx(numeric, abs=0.02)


def test_blur_widens_a_profile_and_a_ball_is_narrower_than_a_wire() -> None:
    at = np.array([2.0])
    sharp, soft = wire_profile(2.3, 0.8, 0.6), wire_profile(2.3, 0.8, 1.8)
    assert soft.reach_px > sharp.reach_px
    assert soft.heights(np.array([3.0])) > sharp.heights(np.array([3.0]))
    assert ball_profile(2.3, 0.8, 1.1).heights(at) < wire_profile(2.3, 0.8, 1.1).heights(at)


@pytest.mark.parametrize("wire", list(Wire))
def test_feet_are_found_again_from_beside_the_wire(wire: Wire, make_view: Callable[..., View], guide: Guide) -> None:
    view = make_view(28.0, 50.0, 110.0)
    samples = sample_wires(view, guide)
    samples = samples.chosen(samples.wire == wire)
    away = np.random.default_rng(2).uniform(-6.0, 6.0, len(samples.along))
    found = feet(view, guide, wire, samples.points + away[:, None] * samples.normals)
    assert found.distance_px == pytest.approx(away, abs=1e-3)
    turned = (found.along - samples.along + np.pi) % (2.0 * np.pi) - np.pi
    assert np.abs(turned * found.speed_px).max() < 0.1  # px along the wire, a fortieth of a piece


def neighbours(count: int, length_px: float) -> Neighbours:
    """Places on one wire, 4 px apart."""
    points = np.column_stack((4.0 * np.arange(count), np.zeros(count)))
    return Neighbours.of(np.zeros(count, dtype=np.intp), points, length_px)


def nearness(count: int, length_px: float) -> Array:
    """Correlation (n, n) of the same places' common error."""
    along = 4.0 * np.arange(count)
    return np.exp(-np.abs(along[:, None] - along) / length_px)


def test_common_and_own_noise_are_told_apart() -> None:
    beside, rng = neighbours(400, 7.0), np.random.default_rng(4)
    root = np.linalg.cholesky(0.12**2 * (0.8 * nearness(400, 7.0) + 0.2 * np.eye(400)))
    every, sd_px = np.ones(400, dtype=bool), np.full(400, 0.03)
    found = [WireNoise.measured(root @ rng.normal(size=400), sd_px, every, beside) for _ in range(20)]
    assert np.median([one.shared for one in found]) == pytest.approx(0.8, abs=0.2)  # the scatter around takes some
    assert np.median([one.sd_px for one in found]) == pytest.approx(0.12, rel=0.15)


def test_white_noise_shares_nothing() -> None:
    beside, every = neighbours(400, 7.0), np.ones(400, dtype=bool)
    found = WireNoise.measured(np.random.default_rng(5).normal(0.0, 0.1, 400), np.zeros(400), every, beside)
    assert found.shared < 0.15
    assert np.median(found.sd_px) == pytest.approx(0.1, rel=0.15)
    still = WireNoise.measured(np.zeros(400), np.zeros(400), every, beside)
    assert still.shared == 0.0
    assert still.sd_px.max() <= LEAST_NOISE_PX


def test_a_stretch_on_rough_ground_is_noisier_than_the_rest() -> None:
    beside, every, rng = neighbours(400, 7.0), np.ones(400, dtype=bool), np.random.default_rng(6)
    truth_px = np.where(np.abs(np.arange(400) - 200) < 40, 0.3, 0.05)
    found = [
        WireNoise.measured(truth_px * rng.normal(size=400), np.full(400, 0.03), every, beside).sd_px for _ in range(10)
    ]
    typical_px = np.median(found, axis=0)
    assert np.median(typical_px[170:230]) > 0.15
    assert np.median(typical_px[:150]) == pytest.approx(0.05, rel=0.3)


def test_places_that_were_given_up_make_their_neighbours_no_noisier() -> None:
    beside, rng = neighbours(400, 7.0), np.random.default_rng(7)
    residual_px = rng.normal(0.0, 0.05, 400)
    residual_px[::5] = 3.0
    seen = np.abs(residual_px) < 1.0
    found = WireNoise.measured(residual_px, np.full(400, 0.03), seen, beside)
    assert np.median(found.sd_px[seen]) < 0.08


def test_places_of_different_wires_are_not_near() -> None:
    points = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 4.1]])
    beside = Neighbours.of(np.array([0, 0, 1], dtype=np.intp), points, 5.0)
    assert beside.alike == pytest.approx([np.exp(-1.0), 0.0])
    assert [pair.tolist() for pair in beside.pairs] == [beside.alike.tolist()]


@pytest.mark.parametrize("shared", [0.0, 0.7])
@pytest.mark.parametrize("coefficients", [0, 3])
def test_solving_undoes_the_covariance_of_all_places(shared: float, coefficients: int) -> None:
    rng = np.random.default_rng(6)
    weight, sd_px = rng.uniform(1e-6, 1.0, 60), rng.uniform(0.02, 0.1, 60)
    bend = rng.normal(0.0, 0.1, (60, coefficients))
    own = np.outer(sd_px, sd_px) * (shared * nearness(60, 9.0) + (1.0 - shared) * np.eye(60))
    dense = own / np.sqrt(np.outer(weight, weight)) + bend @ bend.T
    covariance = PlaceCovariance.of(WireNoise(sd_px, shared), neighbours(60, 9.0), weight, bend)
    assert covariance.solved(dense) == pytest.approx(np.eye(60), abs=1e-8)


def test_two_places_at_one_spot_keep_a_finite_covariance() -> None:
    points = np.array([[0.0, 0.0], [0.0, 0.0], [4.0, 0.0]])
    beside = Neighbours.of(np.zeros(3, dtype=np.intp), points, 5.0)
    covariance = PlaceCovariance.of(WireNoise(np.full(3, 0.2), 0.7), beside, np.ones(3), np.zeros((3, 0)))
    assert np.linalg.eigvalsh(covariance.solved(np.eye(3))).min() > 0.0
