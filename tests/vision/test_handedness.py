"""Handedness by a nudge: the rings did what the arm did, or the mirror image of it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simulator.carm.camera import Camera
from simulator.carm.guide import ALL_PARTS, GuideShape, Part
from simulator.carm.render import render
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from vision.handedness import prove_handedness
from vision.motion_agreement import MotionErrors
from vision.refusal import Refusal, RefusalCode
from vision.registered import Registration
from vision.registration import register
from vision.xray import XrayImage

CAMERA = Camera(source_to_image_mm=1000.0, pixel_mm=360.0 / 1024, principal_u_px=514.0, principal_v_px=508.0)
BARE = GuideShape(parts=ALL_PARTS - {Part.BEAD})
ERRORS = MotionErrors(arm_rad=np.radians(0.02), arm_mm=0.1, tcp_rad=np.radians(0.05), tcp_mm=0.1)


def step(y_mm: float, turn_deg: tuple[float, ...] = (0.0, 0.0, 0.0), x_mm: float = 0.0) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(turn_deg, degrees=True).as_matrix()
    pose[:3, 3] = [x_mm, y_mm, 0.0]
    return pose


FIRST = step(0.0)
FIRST[:3, :3] = Rotation.from_euler("xyz", [8.0, -5.0, 20.0], degrees=True).as_matrix()
FIRST[:3, 3] = [10.0, -5.0, 750.0]


@pytest.fixture(scope="module")
def registered(guide, flat_panel):
    """Registrations of a guide without a bead at FIRST followed by a step, of an image that is flipped or not."""
    bare = replace(guide, bead=None)
    known: dict[tuple, Registration] = {}

    def at(moved: np.ndarray, flipped: bool) -> Registration:
        key = (moved.tobytes(), flipped)
        if key not in known:
            scene = Scene(
                CAMERA,
                (PlacedGuide(BARE, FIRST @ moved),),
                (500.0, 500.0),
                intensifier=False,
                exposure=Exposure(bits=16),
            )
            pixels = render(scene, seed=len(known)).pixels.astype(np.float32)
            pixels = np.ascontiguousarray(pixels[:, ::-1]) if flipped else pixels
            image = XrayImage(pixels / 65535.0, 16, "0" * 64)
            found = register(image, bare, flat_panel, handedness_proved=True)
            assert isinstance(found, Registration), found
            known[key] = found
        return known[key]

    return at


def test_a_nudge_along_y_proves_an_image_that_is_not_mirrored(registered) -> None:
    proof = prove_handedness(registered(step(0.0), False), registered(step(6.0), False), step(6.0), ERRORS)
    assert not isinstance(proof, Refusal)
    assert proof.nudge_mm == 6.0
    assert proof.mirrored_chi_square > proof.chi_square + 40.0


@pytest.mark.hazard("H05")
def test_a_nudge_along_y_shows_a_mirror(registered) -> None:
    refused = prove_handedness(registered(step(0.0), True), registered(step(6.0), True), step(6.0), ERRORS)
    assert isinstance(refused, Refusal)
    assert refused.code is RefusalCode.MIRRORED


@pytest.mark.hazard("H05")
@pytest.mark.parametrize("moved", [step(0.0, x_mm=20.0), step(0.0, (0.0, 5.0, 0.0)), step(4.99)])
def test_what_looks_alike_in_a_mirror_proves_nothing(registered, moved: np.ndarray) -> None:
    still = registered(step(0.0), False)
    refused = prove_handedness(still, still, moved, ERRORS)
    assert isinstance(refused, Refusal)
    assert (refused.code, refused.limit) == (RefusalCode.HANDEDNESS_UNPROVED, 5.0)


@pytest.mark.parametrize("told", [step(12.0), step(-12.0), step(6.0, x_mm=15.0)])
def test_a_motion_that_the_images_do_not_show_proves_nothing(registered, told: np.ndarray) -> None:
    """As where the C-arm moved in between."""
    refused = prove_handedness(registered(step(0.0), False), registered(step(6.0), False), told, ERRORS)
    assert isinstance(refused, Refusal)
    assert refused.code is RefusalCode.HANDEDNESS_UNPROVED
