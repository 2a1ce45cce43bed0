"""The sample images with truth, where they are present: beside the checkout or where COAXIAL_SAMPLES says."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vision.devices import CArm, Guide
from vision.refusal import Refusal, RefusalCode
from vision.registered import PixelSpace, Registration
from vision.registration import register
from vision.targeting import Targeting, target
from vision.xray import XrayImage, decode

_BESIDE = Path(__file__).parents[2].parent / "shared" / "samples"
SAMPLES = Path(os.environ.get("COAXIAL_SAMPLES", _BESIDE))
NAMES = sorted(path.stem for path in SAMPLES.glob("*.json")) if SAMPLES.is_dir() else []
GREATEST_ANGLE_DEG, GREATEST_DISTANCE_MM = 0.15, 0.40

pytestmark = pytest.mark.skipif(not NAMES, reason="no sample images: set COAXIAL_SAMPLES to their folder")


@pytest.fixture(params=NAMES or ["none"])
def truth(request: pytest.FixtureRequest) -> dict[str, Any]:
    """One sample's truth."""
    loaded: dict[str, Any] = json.loads((SAMPLES / f"{request.param}.json").read_bytes())
    return loaded


@pytest.fixture
def image(truth: dict[str, Any]) -> XrayImage:
    """Its image."""
    decoded = decode((SAMPLES / truth["image"]).read_bytes())
    assert isinstance(decoded, XrayImage)
    return decoded


@pytest.fixture
def carm(truth: dict[str, Any], flat_panel: CArm, intensifier: CArm) -> CArm:
    """The C-arm that took it."""
    return flat_panel if "flat" in truth["carm"] else intensifier


def changed(image: XrayImage, pixels: Any) -> XrayImage:
    """The image with other pixels."""
    return XrayImage(np.ascontiguousarray(pixels), image.bits, image.sha256)


@pytest.mark.parametrize("turned", [False, True])
def test_samples_register_however_they_are_turned(
    turned: bool, truth: dict[str, Any], image: XrayImage, carm: CArm, guide: Guide
) -> None:
    turns = 1 + NAMES.index(Path(truth["image"]).stem) % 3 if turned else 0
    registration = register(changed(image, np.rot90(image.pixels, turns)), guide, carm)
    assert isinstance(registration, Registration), registration
    u, v = truth["target_raw_px"]
    for _ in range(turns):
        u, v = v, image.rows - 1 - u
    goal = target(registration, np.array([u, v]), PixelSpace.RAW)
    assert isinstance(goal, Targeting)
    source_from_guide = np.array(truth["source_from_guide_mm"])
    source_from_goal = source_from_guide @ goal.guide_from_goal
    axis, tcp = source_from_goal[:3, 2], source_from_goal[:3, 3]
    across_mm = (np.array(truth["target_ideal_px"]) - truth["principal_point_ideal_px"]) * truth["pixel_size_mm"]
    ray = np.array([*across_mm, truth["source_to_image_distance_mm"]])
    ray /= np.linalg.norm(ray)
    place = ray * (np.linalg.norm(source_from_guide[:3, 3]) - 140.0)
    assert np.degrees(np.arctan2(np.linalg.norm(np.cross(axis, ray)), axis @ ray)) < GREATEST_ANGLE_DEG
    assert np.linalg.norm(np.cross(place - tcp, axis)) < GREATEST_DISTANCE_MM


def test_flipped_samples_are_refused_as_mirrored(
    truth: dict[str, Any], image: XrayImage, carm: CArm, guide: Guide
) -> None:
    axis = NAMES.index(Path(truth["image"]).stem) % 2
    refusal = register(changed(image, np.flip(image.pixels, axis)), guide, carm)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.MIRRORED
