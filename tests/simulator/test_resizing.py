"""A scene on another detector: the same things at the same places, in other pixels."""

import numpy as np
import pytest

from simulator.carm.drawing import random_scene
from simulator.carm.faulted import Fault, faulted_scene
from simulator.carm.quick_render import render_quickly
from simulator.carm.resizing import resized
from simulator.carm.scene import Scene

FIELD_MM = 360.0


def _lattice(scene: Scene) -> np.ndarray:
    """Raw pixels (n, 2) at the same shares of any image's side."""
    shares = np.linspace(0.1, 0.9, 7)
    return np.stack(np.meshgrid(shares, shares), axis=-1).reshape(-1, 2) * scene.camera.columns - 0.5


def _share(scene: Scene, pixels: np.ndarray) -> np.ndarray:
    return (np.asarray(pixels) + 0.5) / scene.camera.columns


def test_same_detector_changes_nothing() -> None:
    scene = random_scene(3)
    same = resized(scene, 1024, FIELD_MM)
    assert same.camera == scene.camera
    assert same.distortion == scene.distortion
    assert same.exposure == scene.exposure
    assert same.target_ideal_px == pytest.approx(scene.target_ideal_px)


@pytest.mark.parametrize(("side_px", "field_mm"), [(512, 360.0), (2048, 229.0)])
def test_bends_principal_point_and_target_keep_their_share_of_the_image(side_px: int, field_mm: float) -> None:
    scene = random_scene(4, "strong")
    other = resized(scene, side_px, field_mm)
    bent, bent_there = (one.distortion.ideal_from_raw(_lattice(one)) for one in (scene, other))

    assert _share(other, bent_there) == pytest.approx(
        _share(scene, bent), abs=1e-4
    )  # bends count from a pixel less than the side
    assert _share(other, other.target_ideal_px) == pytest.approx(_share(scene, scene.target_ideal_px))
    centres = (one.camera.principal_u_px for one in (other, scene))
    assert _share(other, next(centres)) == pytest.approx(_share(scene, next(centres)))
    assert other.camera.pixel_mm * side_px == pytest.approx(field_mm)


def test_another_field_than_the_file_s_stays_another_field() -> None:
    zoomed = faulted_scene(Fault.ZOOMED, 1).scene
    small = resized(zoomed, 512, FIELD_MM)
    assert small.camera.pixel_mm == pytest.approx(2.0 * zoomed.camera.pixel_mm)


def test_shutters_and_motion_keep_their_size_in_the_image() -> None:
    collimated, cropped, blurred = (
        faulted_scene(fault, 1).scene for fault in (Fault.COLLIMATED, Fault.CROPPED, Fault.MOTION_BLUR)
    )
    blades = resized(collimated, 512, FIELD_MM).exposure.collimator_px
    assert np.array(blades) == pytest.approx(np.array(collimated.exposure.collimator_px) / 2.0)
    crop = resized(cropped, 512, FIELD_MM).exposure.crop_px
    assert np.array(crop) == pytest.approx(np.array(cropped.exposure.crop_px) / 2.0, abs=1.0)
    assert resized(blurred, 512, FIELD_MM).exposure.motion_px == pytest.approx(blurred.exposure.motion_px / 2.0)


def test_half_the_pixels_show_the_same_picture() -> None:
    scene = random_scene(5, "flat")
    full, half = render_quickly(scene, 0).pixels, render_quickly(resized(scene, 512, FIELD_MM), 0).pixels
    averaged = full.astype(float).reshape(512, 2, 512, 2).mean(axis=(1, 3)) / np.iinfo(full.dtype).max
    # the wires' flanks are steep, the noise is another one
    assert np.median(np.abs(averaged - half / np.iinfo(half.dtype).max)) < 0.01
