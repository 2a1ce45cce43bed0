"""The shadows' profiles, the nearest places on a wire, and the noise of neighbours."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from vision.devices import Guide
from vision.projection import View
from vision.wire_model import Wire, feet, sample_wires
from vision.wire_noise import LEAST_NOISE_PX, Whitening, WireNoise, nearness
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


def along_a_wire(count: int) -> tuple[NDArray[np.intp], Array]:
    return np.zeros(count, dtype=np.intp), np.column_stack((4.0 * np.arange(count), np.zeros(count)))


def test_common_and_own_noise_are_told_apart() -> None:
    wire, points = along_a_wire(400)
    near = nearness(wire, points, 7.0)
    rng, sd_px = np.random.default_rng(4), np.full(400, 0.03)
    truth = WireNoise(own_px=0.04, shared_px=0.1)
    root = np.linalg.cholesky(truth.covariance(sd_px, near))
    found = [WireNoise.measured(root @ rng.normal(size=400), sd_px, np.ones(400, dtype=bool), near) for _ in range(20)]
    assert np.median([one.shared_px for one in found]) == pytest.approx(0.1, rel=0.15)
    assert np.median([one.own_px for one in found]) == pytest.approx(0.04, abs=0.03)


def test_white_noise_shares_nothing() -> None:
    wire, points = along_a_wire(400)
    near = nearness(wire, points, 7.0)
    noise = np.random.default_rng(5).normal(0.0, 0.1, 400)
    found = WireNoise.measured(noise, np.zeros(400), np.ones(400, dtype=bool), near)
    assert found.shared_px < 0.04
    assert found.own_px == pytest.approx(0.1, rel=0.15)
    still = WireNoise.measured(np.zeros(400), np.zeros(400), np.ones(400, dtype=bool), near)
    assert still == WireNoise(LEAST_NOISE_PX, 0.0)


def test_places_of_different_wires_are_not_near() -> None:
    near = nearness(np.array([0, 0, 1], dtype=np.intp), np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 4.1]]), 5.0)
    assert near[0, 1] == pytest.approx(np.exp(-1.0))
    assert near[1, 2] == 0.0


def test_whitened_values_are_independent() -> None:
    wire, points = along_a_wire(60)
    covariance = WireNoise(0.1, 0.2).covariance(np.full(60, 0.05), nearness(wire, points, 9.0))
    whitened = Whitening.of(covariance)
    root = whitened(np.eye(60))
    assert root @ covariance @ root.T == pytest.approx(np.eye(60), abs=1e-9)
    assert whitened.solved(covariance[:, 3]) == pytest.approx(np.eye(60)[3], abs=1e-9)
