"""Lengths inside wires, against counting along finely sampled rays."""

import numpy as np
import pytest

from simulator.carm.chords import ball_chord, ring_chord, rod_chord, shell_chord

_STEP_MM = 0.002  # of the counting; a chord is known to two steps
_SOURCE = np.array([14.0, -22.0, -750.0])


def _rays_to(points: np.ndarray) -> np.ndarray:
    rays = points - _SOURCE
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)


def _counted(points: np.ndarray, rays: np.ndarray, inside) -> np.ndarray:
    along = np.arange(-5.0, 5.0, _STEP_MM)
    samples = points[:, None, :] + along[None, :, None] * rays[:, None, :]
    return inside(samples).sum(axis=1) * _STEP_MM


@pytest.mark.parametrize("tilt_deg", [0.0, 20.0, 40.0])
def test_ring_chord_is_what_a_count_inside_the_torus_gives(tilt_deg: float) -> None:
    rng = np.random.default_rng(3)
    turn = rng.uniform(0.0, 2.0 * np.pi, 60)
    points = np.stack([20.0 * np.cos(turn), 20.0 * np.sin(turn), np.zeros(60)], axis=1)
    points += rng.uniform(-0.7, 0.7, (60, 3))
    tilt = np.deg2rad(tilt_deg)
    source = 750.0 * np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    rays = points - source
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)

    def in_torus(p: np.ndarray) -> np.ndarray:
        return (np.hypot(p[..., 0], p[..., 1]) - 20.0) ** 2 + p[..., 2] ** 2 < 0.6**2

    counted = _counted(points, rays, in_torus)
    assert counted.max() > 1.1
    np.testing.assert_allclose(ring_chord(source, rays, 20.0, 0.6), counted, atol=3 * _STEP_MM)


def test_rod_chord_ends_square_at_both_ends() -> None:
    rng = np.random.default_rng(4)
    points = np.column_stack([rng.uniform(25.0, 67.0, 80), rng.uniform(-0.7, 0.7, (80, 2))])
    rays = _rays_to(points)

    def in_rod(p: np.ndarray) -> np.ndarray:
        return (np.hypot(p[..., 1], p[..., 2]) < 0.6) & (p[..., 0] > 26.0) & (p[..., 0] < 66.0)

    np.testing.assert_allclose(
        rod_chord(_SOURCE, rays, 26.0, 66.0, 0.6), _counted(points, rays, in_rod), atol=3 * _STEP_MM
    )


def test_ball_chord_is_its_diameter_through_the_middle_and_nothing_outside() -> None:
    rays = _rays_to(np.array([[0.0, 0.0, 0.0], [1.6, 0.0, 0.0]]))
    np.testing.assert_allclose(ball_chord(_SOURCE, rays, 1.5), [3.0, 0.0], atol=1e-9)


def test_ray_beside_everything_meets_no_metal() -> None:
    rays = _rays_to(np.array([[200.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    assert ring_chord(_SOURCE, rays, 20.0, 0.6).tolist() == [0.0, 0.0]
    assert shell_chord(_SOURCE, rays, 36.0, 33.0, (-65.0, 5.0))[0] == 0.0
