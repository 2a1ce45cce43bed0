"""Sizes, fields, depths, polarities and look-ups of images: the errors stay what the pixels allow."""

import io
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import cv2
import numpy as np
import pydicom
import pytest
from numpy.typing import NDArray
from pydicom.uid import ExplicitVRLittleEndian, XRayAngiographicImageStorage

from simulator.carm.drawing import PIXEL_MM, random_scene
from simulator.carm.render import RenderedXray, render
from simulator.carm.scene import Scene
from vision.corrected_image import correct
from vision.devices import CArm, Guide
from vision.refusal import Refusal, RefusalCode
from vision.registered import PixelSpace, Registration
from vision.registration import register
from vision.targeting import Targeting, target
from vision.xray import XrayImage, decode

Array = NDArray[np.float64]

SIDE = 1024
# The limits of the acceptance at 0.35 mm a pixel; an image of 512 pixels has half of it
GREATEST_ANGLE_DEG, GREATEST_DISTANCE_MM = 0.15, 0.40


def resized(scene: Scene, side_px: int, field_mm: float) -> Scene:
    """The scene on a detector of other pixels, all that is counted in pixels with it; the same dose per area."""
    camera, scale = scene.camera, side_px / SIDE
    middle = (side_px - 1) / 2.0
    finer = PIXEL_MM * side_px / field_mm
    pose = scene.guides[0].source_from_guide.copy()
    if field_mm < 300.0:  # the guide is as long as a small field: its middle in the beam's
        pose[:2, 3] = -22.0 * pose[:2, 0]
    waves = tuple(
        replace(
            wave,
            amplitude_px=(wave.amplitude_px[0] * scale, wave.amplitude_px[1] * scale),
            cycles_per_px=(wave.cycles_per_px[0] / scale, wave.cycles_per_px[1] / scale),
        )
        for wave in scene.distortion.waves
    )
    shift = scene.distortion.shift_px
    return replace(
        scene,
        camera=replace(
            camera,
            pixel_mm=field_mm / side_px,
            rows=side_px,
            columns=side_px,
            principal_u_px=middle + (camera.principal_u_px - 511.5) * scale,
            principal_v_px=middle + (camera.principal_v_px - 511.5) * scale,
        ),
        distortion=replace(
            scene.distortion, centre_px=middle, shift_px=(shift[0] * scale, shift[1] * scale), waves=waves
        ),
        guides=(replace(scene.guides[0], source_from_guide=pose),),
        target_ideal_px=(middle + 30.0 * scale, middle - 50.0 * scale),
        exposure=replace(
            scene.exposure,
            blur_px=max(0.6, scene.exposure.blur_px * finer),
            photons=scene.exposure.photons / finer**2,
        ),
    )


def assert_aims(image: Any, guide: Guide, carm: CArm, truth: dict[str, Any]) -> None:
    """Registered, and the commanded move within the limits and within its own bounds."""
    assert isinstance(image, XrayImage)
    registration = register(image, guide, carm)
    assert isinstance(registration, Registration), registration
    goal = target(registration, np.array(truth["target_raw_px"]), PixelSpace.RAW)
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


@pytest.mark.parametrize(
    ("group", "side_px", "field_mm"),
    [
        ("ii", 512, 229.0),
        ("ii", 512, 360.0),
        ("ii", 768, 406.0),
        ("ii", 2048, 305.0),
        ("flat", 512, 406.0),
        ("flat", 2048, 360.0),
    ],
)
def test_every_size_and_field_registers(
    group: str, side_px: int, field_mm: float, guide: Guide, flat_panel: CArm, intensifier: CArm
) -> None:
    xray = render(resized(random_scene(2, group), side_px, field_mm), 2)
    carm = replace(flat_panel if group == "flat" else intensifier, field_of_view_mm=field_mm)
    image = decode(cv2.imencode(".png", xray.pixels)[1].tobytes())
    assert_aims(image, guide, carm, xray.truth)


@cache
def linear(group: str) -> RenderedXray:
    """An image of 16 bits whose pixels are proportional to the intensity."""
    scene = random_scene(2, group)
    return render(replace(scene, exposure=replace(scene.exposure, bits=16, gamma=1.0)), 2)


LOOK_UPS: dict[str, Callable[[Array], Array]] = {
    "gamma 0.4": lambda share: share**0.4,
    "gamma 2.2": lambda share: share**2.2,
    "logarithmic": lambda share: np.asarray(np.log1p(1000.0 * share) / np.log(1001.0)),
}


@pytest.mark.parametrize(("name", "bits"), [("gamma 0.4", 8), ("gamma 2.2", 16), ("logarithmic", 8)])
@pytest.mark.parametrize("group", ["ii", "flat"])
def test_every_look_up_registers(
    group: str, name: str, bits: int, guide: Guide, flat_panel: CArm, intensifier: CArm
) -> None:
    xray = linear(group)
    shown = np.rint(LOOK_UPS[name](xray.pixels / 65535.0) * (2**bits - 1))
    data = cv2.imencode(".png", shown.astype(np.uint8 if bits == 8 else np.uint16))[1].tobytes()
    assert_aims(decode(data), guide, flat_panel if group == "flat" else intensifier, xray.truth)


def dicom(values: NDArray[np.uint16], bits: int, photometric: str) -> bytes:
    """A DICOM file of an X-ray angiography image."""
    dataset = pydicom.Dataset()
    dataset.file_meta = pydicom.dataset.FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.file_meta.MediaStorageSOPClassUID = dataset.SOPClassUID = XRayAngiographicImageStorage
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID = "1.2.3"
    dataset.Modality, dataset.PhotometricInterpretation, dataset.SamplesPerPixel = "XA", photometric, 1
    dataset.Rows, dataset.Columns = values.shape
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit, dataset.PixelRepresentation = 16, bits, bits - 1, 0
    dataset.PixelData = values.tobytes()
    buffer = io.BytesIO()
    dataset.save_as(buffer, enforce_file_format=True)
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("bits", "stored_in", "photometric"), [(10, 10, "MONOCHROME2"), (12, 16, "MONOCHROME2"), (14, 14, "MONOCHROME1")]
)
def test_every_depth_and_polarity_registers(
    bits: int, stored_in: int, photometric: str, guide: Guide, intensifier: CArm
) -> None:
    xray = linear("ii")
    values = np.rint(xray.pixels / 65535.0 * (2**bits - 1)).astype(np.uint16)
    if photometric == "MONOCHROME1":
        values = (2**bits - 1 - values).astype(np.uint16)
    assert_aims(decode(dicom(values, stored_in, photometric)), guide, intensifier, xray.truth)


@pytest.mark.parametrize("share", [0.8, 0.97, 1.03, 1.25])
def test_a_panel_s_other_field_is_refused_where_the_header_tells_it(share: float, flat_panel: CArm) -> None:
    pixels = np.full((512, 512), 0.5, dtype=np.float32)
    file_mm = flat_panel.field_of_view_mm / 512.0
    refusal = correct(XrayImage(pixels, 16, "0" * 64, file_mm * share), flat_panel)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.SCALE_MISMATCH
    assert refusal.measured == pytest.approx(abs(share - 1.0))
    assert not isinstance(correct(XrayImage(pixels, 16, "0" * 64, file_mm), flat_panel), Refusal)
