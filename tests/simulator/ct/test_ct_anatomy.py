"""Radiographs of a CT against closed forms, and against the renderer of solids."""

import time
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simulator.carm.anatomy import STEP_PX, Body
from simulator.carm.camera import Camera, pixel_grid
from simulator.carm.drawing import random_scene
from simulator.carm.render import render
from simulator.ct.anatomy import anatomy_of
from simulator.ct.reading import read_ct
from simulator.ct.volume import CtVolume
from simulator.ct.voxels import scan
from simulator.patient import build_body

_CAMERA = Camera(1000.0, 360.0 / 1024.0, 505.0, 517.0)
_GRID = pixel_grid(_CAMERA, 8)


def _source_from_patient(angles_deg: tuple[float, float, float], looked_at: np.ndarray) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xyz", angles_deg, degrees=True).as_matrix()
    pose[:3, 3] = [9.0, -14.0, 610.0] - pose[:3, :3] @ looked_at
    return pose


@pytest.mark.parametrize("angles_deg", [(-90.0, 0.0, 0.0), (-60.0, 35.0, 70.0), (10.0, 5.0, 0.0), (90.0, 20.0, -120.0)])
def test_line_integrals_are_those_of_the_closed_form(
    blob_ct, tmp_path: Path, angles_deg: tuple[float, float, float]
) -> None:
    anatomy = anatomy_of(read_ct(blob_ct.write_nifti(tmp_path / "ct.nii")))
    pose = _source_from_patient(angles_deg, blob_ct.centre_mm)
    found = anatomy.depths(_CAMERA, pose, _GRID)
    rotation, origin = pose[:3, :3], -pose[:3, :3].T @ pose[:3, 3]
    expected = blob_ct.depths(origin, _CAMERA.rays(_GRID) @ rotation)
    assert expected.max() == pytest.approx(2.35, abs=0.02)
    core = expected > 0.1 * expected.max()  # the rest grazes the edge where air is cut off, a step of 50 HU
    np.testing.assert_allclose(found[core], expected[core], atol=0.003 * expected.max())
    np.testing.assert_allclose(found, expected, atol=0.008 * expected.max())


def test_scanner_noise_in_air_does_not_add_up(blob_ct) -> None:
    noisy = blob_ct.hounsfield + np.random.default_rng(3).normal(0.0, 15.0, blob_ct.hounsfield.shape)
    pose = np.eye(4)
    pose[:3, 3] = -np.array(noisy.shape) / 2.0
    anatomy = anatomy_of(CtVolume(noisy.astype(np.float32), pose))
    depths = anatomy.depths(_CAMERA, _source_from_patient((-90.0, 0.0, 0.0), np.zeros(3)), _GRID)
    assert np.abs(depths[0]).max() < 0.01


def test_scanned_spine_looks_as_the_solids_do() -> None:
    body = build_body(1)
    solids = Body(body.bone, body.soft[:1], (), ())  # without bubbles, whose overlaps a CT shows as air
    pose = np.eye(4)
    pose[:3, :3] *= 2.0
    pose[:3, 3] = (-174.0, -126.0, -34.0)
    anatomy = anatomy_of(scan(solids, pose, (175, 120, 35)))
    view = _source_from_patient((90.0, 0.0, 180.0), np.zeros(3))
    found, expected = (one.depths(_CAMERA, view, pixel_grid(_CAMERA, STEP_PX)) for one in (anatomy, solids))
    # Means over 7 mm, as voxels of 2 mm blur the cortex; only rays that stay within the scanned slab.
    difference = cv2.blur(found - expected, (16, 16))[184:264, 120:400]
    assert np.sqrt(np.mean(np.square(difference))) < 0.01 * expected[184:264, 120:400].mean()
    aside = cv2.blur(found - np.roll(expected, 3, axis=1), (16, 16))[184:264, 120:400]  # by 1.3 mm
    assert np.sqrt(np.mean(np.square(aside))) > 2.0 * np.sqrt(np.mean(np.square(difference)))


def test_image_of_a_ct_is_made_within_two_seconds_of_one_core() -> None:
    hounsfield = np.full((256, 256, 200), 30.0, dtype=np.float32)
    hounsfield[:8], hounsfield[100:120] = -1000.0, 700.0
    pose = np.diag([1.2, 1.2, 1.5, 1.0])
    pose[:3, 3] = (-150.0, -150.0, -150.0)
    scene = replace(random_scene(2), body=anatomy_of(CtVolume(hounsfield, pose)))
    render(scene, 1)  # imports and caches
    started_s = time.process_time()
    assert render(scene, 1).pixels.shape == (1024, 1024)
    assert time.process_time() - started_s < 2.0
