"""Turns, depths, look-ups, sizes, fields, polarities and detectors: the errors stay what the pixels allow."""

import io
import itertools
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pydicom
import pytest
from numpy.typing import NDArray
from pydicom.uid import ExplicitVRLittleEndian, XRayAngiographicImageStorage

from simulator.carm.drawing import random_scene
from simulator.carm.quick_render import render_quickly
from simulator.carm.render import RenderedXray
from simulator.carm.resizing import resized
from simulator.carm.scene import Scene
from vision.corrected_image import correct
from vision.devices import CArm, Guide
from vision.refusal import Refusal, RefusalCode
from vision.registered import PixelSpace, Registration
from vision.registration import register
from vision.targeting import Targeting, target
from vision.xray import XrayImage, decode

Array = NDArray[np.float64]

# The limits of the acceptance at 0.35 mm a pixel; an image of 512 pixels has half of it
GREATEST_ANGLE_DEG, GREATEST_DISTANCE_MM = 0.15, 0.40
LOOK_UPS: dict[str, Callable[[Array], Array]] = {
    "linear": lambda share: share,
    "gamma 0.4": lambda share: share**0.4,
    "gamma 2.2": lambda share: share**2.2,
    "logarithmic": lambda share: np.asarray(np.log1p(1000.0 * share) / np.log(1001.0)),
}


class Kind(NamedTuple):
    """How an image may be made and sent; fields of 9, 12, 14 and 16 inch."""

    quarter_turns: int
    bits: int
    look_up: str
    side_px: int
    field_mm: float
    photometric: str
    group: str


# An orthogonal array: every pair of levels of every two columns is there.
KINDS = (
    Kind(0, 8, "linear", 512, 229.0, "MONOCHROME2", "ii"),
    Kind(0, 10, "gamma 0.4", 1024, 406.0, "MONOCHROME1", "flat"),
    Kind(0, 12, "gamma 2.2", 2048, 305.0, "MONOCHROME1", "ii"),
    Kind(0, 16, "logarithmic", 768, 360.0, "MONOCHROME2", "flat"),
    Kind(1, 8, "gamma 0.4", 768, 305.0, "MONOCHROME1", "ii"),
    Kind(1, 10, "linear", 2048, 360.0, "MONOCHROME2", "flat"),
    Kind(1, 12, "logarithmic", 1024, 229.0, "MONOCHROME2", "ii"),
    Kind(1, 16, "gamma 2.2", 512, 406.0, "MONOCHROME1", "flat"),
    Kind(2, 8, "gamma 2.2", 1024, 360.0, "MONOCHROME2", "ii"),
    Kind(2, 10, "logarithmic", 512, 305.0, "MONOCHROME1", "flat"),
    Kind(2, 12, "linear", 768, 406.0, "MONOCHROME1", "ii"),
    Kind(2, 16, "gamma 0.4", 2048, 229.0, "MONOCHROME2", "flat"),
    Kind(3, 8, "logarithmic", 2048, 406.0, "MONOCHROME2", "flat"),
    Kind(3, 10, "gamma 2.2", 768, 229.0, "MONOCHROME1", "ii"),
    Kind(3, 12, "gamma 0.4", 512, 360.0, "MONOCHROME1", "flat"),
    Kind(3, 16, "linear", 1024, 305.0, "MONOCHROME2", "ii"),
)

_SEEDS = {8: 2, 9: 2}  # of the scenes, else a kind's place: with few pixels or few dark levels some are refused


def test_the_kinds_hold_every_pair_of_levels() -> None:
    columns = list(zip(*KINDS, strict=True))
    assert [len(set(column)) for column in columns] == [4, 4, 4, 4, 4, 2, 2]
    for one, other in itertools.combinations(columns, 2):
        assert len(set(zip(one, other, strict=True))) == len(set(one)) * len(set(other))


def exposed(group: str, side_px: int, field_mm: float, seed: int) -> RenderedXray:
    """An image of 16 bits whose pixels are proportional to the intensity."""
    scene = resized(random_scene(seed, group), side_px, field_mm)
    linear = replace(scene, exposure=replace(scene.exposure, bits=16, gamma=1.0))
    return render_quickly(linear if field_mm > 350.0 else centred(linear), seed)


def centred(scene: Scene) -> Scene:
    """The guide, which is as long as a small field is wide, with its middle in the beam's."""
    (guide,) = scene.guides
    pose = guide.source_from_guide.copy()
    pose[:2, 3] = -22.0 * pose[:2, 0]
    return replace(scene, guides=(replace(guide, source_from_guide=pose),))


def dicom(values: NDArray[np.uint16], bits: int, photometric: str) -> bytes:
    """A DICOM file of an X-ray angiography image."""
    dataset = pydicom.Dataset()
    dataset.file_meta = pydicom.dataset.FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.file_meta.MediaStorageSOPClassUID = dataset.SOPClassUID = XRayAngiographicImageStorage
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID = "1.2.3"
    dataset.Modality, dataset.PhotometricInterpretation, dataset.SamplesPerPixel = "XA", photometric, 1
    dataset.Rows, dataset.Columns = values.shape
    dataset.BitsAllocated, dataset.BitsStored = (8, 8) if bits == 8 else (16, bits)
    dataset.HighBit, dataset.PixelRepresentation = bits - 1, 0
    dataset.PixelData = (values.astype(np.uint8) if bits == 8 else values).tobytes()
    buffer = io.BytesIO()
    dataset.save_as(buffer, enforce_file_format=True)
    return buffer.getvalue()


def quantised(shown: Array, bits: int, photometric: str) -> NDArray[np.uint16]:
    """Shares of white as the numbers of a file."""
    dark_is_high = photometric == "MONOCHROME1"
    return np.rint((1.0 - shown if dark_is_high else shown) * (2**bits - 1)).astype(np.uint16)


def turned_truth(xray: RenderedXray, quarter_turns: int) -> tuple[float, float]:
    """The target's raw pixel in the image turned counter-clockwise."""
    u, v = xray.truth["target_raw_px"]
    for _ in range(quarter_turns):
        u, v = v, xray.pixels.shape[0] - 1.0 - u
    return u, v


def assert_aims(image: Any, guide: Guide, carm: CArm, truth: dict[str, Any], pixel: tuple[float, float]) -> None:
    """Registered, and the commanded move within the limits."""
    assert isinstance(image, XrayImage)
    registration = register(image, guide, carm)
    assert isinstance(registration, Registration), registration
    goal = target(registration, pixel, PixelSpace.RAW)
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


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: "-".join(map(str, kind)))
def test_every_kind_of_image_registers(kind: Kind, guide: Guide, flat_panel: CArm, intensifier: CArm) -> None:
    xray = exposed(kind.group, kind.side_px, kind.field_mm, _SEEDS.get(KINDS.index(kind), KINDS.index(kind)))
    shown = LOOK_UPS[kind.look_up](np.rot90(xray.pixels, kind.quarter_turns) / 65535.0)
    image = decode(dicom(quantised(shown, kind.bits, kind.photometric), kind.bits, kind.photometric))
    carm = replace(flat_panel if kind.group == "flat" else intensifier, field_of_view_mm=kind.field_mm)
    assert_aims(image, guide, carm, xray.truth, turned_truth(xray, kind.quarter_turns))


def test_a_depth_that_the_file_overstates_registers(guide: Guide, intensifier: CArm) -> None:
    xray = exposed("ii", 1024, 360.0, 2)
    image = decode(dicom(quantised(xray.pixels / 65535.0, 12, "MONOCHROME2"), 16, "MONOCHROME2"))
    assert_aims(image, guide, intensifier, xray.truth, turned_truth(xray, 0))


@pytest.mark.parametrize("share", [0.8, 0.97, 1.03, 1.25])
def test_a_panel_s_other_field_is_refused_where_the_header_tells_it(share: float, flat_panel: CArm) -> None:
    pixels = np.full((512, 512), 0.5, dtype=np.float32)
    file_mm = flat_panel.field_of_view_mm / 512.0
    refusal = correct(XrayImage(pixels, 16, "0" * 64, file_mm * share), flat_panel)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.SCALE_MISMATCH
    assert refusal.measured == pytest.approx(abs(share - 1.0))
    assert not isinstance(correct(XrayImage(pixels, 16, "0" * 64, file_mm), flat_panel), Refusal)
