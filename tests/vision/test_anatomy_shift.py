"""The shift of the anatomy between two rendered images (H34), while the guide moves and the plate does not."""

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from simulator.carm.drawing import random_scene
from simulator.carm.plate import draw_plate
from simulator.carm.render import render
from simulator.carm.scene import Scene
from vision.anatomy_shift import AnatomyShift, Exposed, compare_anatomy
from vision.corrected_image import CorrectedImage, correct
from vision.devices import CArm
from vision.projection import Intrinsics, View
from vision.registered import Registration
from vision.xray import XrayImage, decode

Array = NDArray[np.float64]

TARGET_PX = np.array([530.0, 490.0])
DEPTH_MM = 80.0
Expose = Callable[..., Exposed]


def decoded(scene: Scene, seed: int) -> XrayImage:
    image = decode(cv2.imencode(".png", render(scene, seed).pixels)[1].tobytes())
    assert isinstance(image, XrayImage)
    return image


def displaced(pose: Array, *mm: float) -> Array:
    moved = pose.copy()
    moved[:3, 3] += mm
    return moved


@pytest.fixture
def expose(make_registration: Callable[..., Registration], flat_panel: CArm, intensifier: CArm) -> Expose:
    """Images of one patient, registered as they truly are."""

    def take(scene: Scene, patient_mm: tuple[float, ...] = (0.0,) * 3, guide_mm: float = 0.0, seed: int = 1) -> Exposed:
        guide = scene.guides[0]
        guide = replace(guide, source_from_guide=displaced(guide.source_from_guide, guide_mm, -guide_mm, 0.0))
        patient = displaced(scene.source_from_patient, *patient_mm)
        image = decoded(replace(scene, guides=(guide,), source_from_patient=patient), seed)
        carm, camera = (flat_panel if scene.plate is None else intensifier), scene.camera
        corrected = correct(image, carm)
        assert isinstance(corrected, CorrectedImage)
        alpha_px = camera.source_to_image_mm / camera.pixel_mm
        intrinsics = Intrinsics(alpha_px, alpha_px, camera.principal_u_px, camera.principal_v_px)
        registration = make_registration(View(intrinsics, guide.source_from_guide), carm)
        return Exposed(corrected, replace(registration, distortion=corrected.plate.map))

    return take


@pytest.fixture
def scene() -> Scene:
    """A flat panel's view of a patient."""
    return random_scene(11, "flat")


def compared(before: Exposed, after: Exposed) -> AnatomyShift:
    return compare_anatomy(before, after, TARGET_PX, DEPTH_MM)


def test_a_patient_who_lies_still_has_not_moved_though_the_guide_has(expose: Expose, scene: Scene) -> None:
    shift = compared(expose(scene), expose(scene, guide_mm=12.0, seed=2))
    assert shift.is_measured
    assert shift.across_mm < 0.2
    assert shift.along_mm < 1.0


@pytest.mark.hazard("H34")
@pytest.mark.parametrize("direction_deg", [20.0, 250.0])
def test_one_millimetre_across_the_beam_is_seen_on_either_detector(
    direction_deg: float, expose: Expose, scene: Scene
) -> None:
    direction = np.radians(direction_deg)
    patient_mm = (float(np.cos(direction)), float(np.sin(direction)), 0.0)
    with_plate = replace(scene, plate=draw_plate(np.random.default_rng(3)), intensifier=True)
    for view in (scene, with_plate):  # the plate's balls stand still and are most of what is sharp
        shift = compared(expose(view), expose(view, patient_mm, guide_mm=12.0, seed=2))
        assert shift.is_measured
        assert shift.across_mm == pytest.approx(1.0, abs=0.2)


def test_along_the_beam_the_scale_tells(expose: Expose, scene: Scene) -> None:
    shift = compared(expose(scene), expose(scene, (0.0, 0.0, 5.0), guide_mm=12.0, seed=2))
    assert shift.along_mm == pytest.approx(5.0, abs=1.5)
    assert shift.across_mm < 0.4


def test_another_exposure_and_display_move_nothing(expose: Expose, scene: Scene) -> None:
    other = replace(scene, exposure=replace(scene.exposure, photons=6000.0, gamma=0.95 * scene.exposure.gamma))
    shift = compared(expose(scene), expose(other, guide_mm=12.0, seed=2))
    assert shift.is_measured
    assert shift.across_mm < 0.2


def test_without_anatomy_nothing_is_measured(expose: Expose, scene: Scene) -> None:
    empty = replace(scene, body=None)
    assert not compared(expose(empty), expose(empty, guide_mm=12.0, seed=2)).is_measured


def test_other_anatomy_is_never_taken_for_a_patient_who_lies_still(expose: Expose, scene: Scene) -> None:
    other = replace(scene, body=random_scene(12, "flat").body)
    for after in (expose(scene, (25.0, -30.0, 0.0), seed=2), expose(other, (0.0, 15.0, 0.0), seed=2)):
        shift = compared(expose(scene), after)
        assert not shift.is_measured or shift.across_mm > 0.5
