"""What an intensifier and its plate do to an image."""

import numpy as np
import pytest
from scipy.ndimage import center_of_mass, label

from simulator.carm.camera import Camera
from simulator.carm.distortion import draw_distortion
from simulator.carm.plate import Plate
from simulator.carm.render import render
from simulator.carm.scene import Exposure, Scene

_CAMERA = Camera(1010.0, 360.0 / 1024.0, 515.0, 506.0)


@pytest.mark.parametrize("strength", [1.0, 1.5])
def test_raw_pixels_return_from_the_ideal_grid(strength: float) -> None:
    axis = np.linspace(0.0, 1023.0, 12)
    raw = np.stack(np.meshgrid(axis, axis), axis=-1)
    for seed in range(5):
        distortion = draw_distortion(np.random.default_rng(seed), strength)
        np.testing.assert_allclose(distortion.raw_from_ideal(distortion.ideal_from_raw(raw)), raw, atol=1e-6)


def test_points_far_outside_the_image_stay_outside() -> None:
    far = np.array([[5000.0, 500.0], [-9000.0, 9000.0]])
    np.testing.assert_array_equal(draw_distortion(np.random.default_rng(1)).raw_from_ideal(far), far)


def test_intensifier_stretches_its_edge_outwards() -> None:
    distortion = draw_distortion(np.random.default_rng(1))
    ideal = distortion.ideal_from_raw(np.array([[20.0, 511.5], [1003.0, 511.5]]))
    assert np.linalg.norm(ideal[1] - ideal[0]) < 983.0 - 15.0


def test_balls_are_fifteen_millimetres_apart_on_the_ideal_grid() -> None:
    distortion = draw_distortion(np.random.default_rng(7))
    scene = Scene(
        _CAMERA,
        (),
        (511.5, 511.5),
        distortion,
        Plate(turn_rad=0.03),
        exposure=Exposure(photons=1e9, gamma=1.0, bits=16),
    )
    pixels = render(scene, 0).pixels.astype(float)
    dark = 0.90 * 65535 - pixels
    dark[pixels == 0] = 0.0
    blobs, count = label(dark > 0.02 * 65535)
    middles = np.array(center_of_mass(np.maximum(dark, 0.0), blobs, range(1, count + 1)))[:, ::-1]
    middles = middles[np.hypot(*(middles - 511.5).T) < 480.0]
    ideal_mm = distortion.ideal_from_raw(middles) * _CAMERA.pixel_mm
    spacing = np.sort(np.linalg.norm(ideal_mm[:, None] - ideal_mm[None], axis=-1), axis=1)[:, 1:3]
    assert len(middles) > 350
    np.testing.assert_allclose(spacing, 15.0, atol=0.05)  # 0.1 px for each of two middles, whose edges are cut
    assert abs(np.median(spacing) - 15.0) < 0.005


def test_covered_part_of_the_plate_shows_no_balls() -> None:
    plate, covered = Plate(), Plate(covered_to_mm=0.0)
    grid = np.stack(np.meshgrid(np.arange(1024.0), np.arange(1024.0)), axis=-1)
    left = grid[..., 0] < _CAMERA.principal_u_px - 1.0
    assert covered.depths(_CAMERA, grid)[left].max() == 0.0
    np.testing.assert_array_equal(covered.depths(_CAMERA, grid)[:, 520:], plate.depths(_CAMERA, grid)[:, 520:])
