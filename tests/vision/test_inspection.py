"""What is shown of an image: as much as was found, at the place where it is."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from simulator.carm.drawing import random_scene
from simulator.carm.guide import ALL_PARTS, GuideShape, Part
from simulator.carm.render import render
from simulator.carm.scene import PlacedGuide, Scene
from vision.devices import CArm, Guide
from vision.drawing import draw, png
from vision.findings import Findings
from vision.inspection import Aim, Inspection, inspect
from vision.panel import Panel
from vision.refusal import Refusal, RefusalCode
from vision.registered import PixelSpace, Registration
from vision.registration import examine
from vision.wire_model import Wire
from vision.xray import XrayImage

FLAT = random_scene(30, "flat")


@cache
def flat_image(*parts: Part, shift_mm: tuple[float, float] | None = None) -> NDArray[np.uint16]:
    """The scene with the guide's parts given, and a second guide where a shift says so."""
    (own,) = FLAT.guides
    guides = [PlacedGuide(replace(own.shape, parts=frozenset(parts)), own.source_from_guide)] if parts else []
    if shift_mm is not None:
        pose = own.source_from_guide.copy()
        pose[:2, 3] += shift_mm
        guides.append(PlacedGuide(GuideShape(), pose))
    return render(replace(FLAT, guides=tuple(guides)), 5).pixels


def image_of(pixels: NDArray[Any]) -> XrayImage:
    """As `decode` would give it."""
    return XrayImage(np.ascontiguousarray(pixels.astype(np.float32) / np.iinfo(pixels.dtype).max), 16, "0" * 64)


@pytest.fixture(scope="module")
def inspected(guide: Guide, flat_panel: CArm) -> Callable[..., Inspection]:
    """Examine an image, each only once, and say what it shows."""
    examined: dict[tuple[bytes, CArm], Findings] = {}

    def run(pixels: NDArray[Any], *target: Any, carm: CArm = flat_panel) -> Inspection:
        image, key = image_of(pixels), (pixels.tobytes(), carm)
        if key not in examined:
            examined[key] = examine(image, guide, carm)
        return inspect(image, guide, carm, examined[key], *target)

    return run


def test_a_registered_image_shows_what_its_residual_is_made_of(inspected: Callable[..., Inspection]) -> None:
    inspection = inspected(flat_image(*ALL_PARTS), (500.0, 480.0), PixelSpace.RAW)
    assert isinstance(inspection.result, Registration)
    (found,) = inspection.views
    assert found.residuals is not None
    assert set(found.residuals.wire) == set(Wire)
    squares = np.average(found.residuals.residual_px**2, weights=found.residuals.weight)
    assert np.sqrt(squares) == pytest.approx(inspection.result.residual_rms_px)
    assert found.bead_px is not None
    assert isinstance(inspection.aim, Aim)
    assert inspection.aim.pixel == pytest.approx((500.0, 480.0))  # a flat panel's grids are one


def test_without_a_target_the_bounds_are_those_of_the_registration(inspected: Callable[..., Inspection]) -> None:
    inspection = inspected(flat_image(*ALL_PARTS))
    assert isinstance(inspection.result, Registration)
    assert isinstance(inspection.aim, Aim)
    predicted = inspection.result.predicted_error_95
    assert inspection.aim.bounds_95.angle_rad == pytest.approx(predicted.angle_rad)
    assert inspection.aim.bounds_95.position_mm == pytest.approx(predicted.position_mm)


def test_a_target_outside_the_image_is_not_drawn(inspected: Callable[..., Inspection]) -> None:
    inspection = inspected(flat_image(*ALL_PARTS), (-50.0, 480.0), PixelSpace.RAW)
    assert isinstance(inspection.aim, Refusal)
    assert inspection.aim.code is RefusalCode.TARGET_OUTSIDE_IMAGE
    assert draw(inspection).size > 0


def test_a_mirrored_image_shows_the_fit_that_the_bead_contradicts(inspected: Callable[..., Inspection]) -> None:
    inspection = inspected(flat_image(*ALL_PARTS)[:, ::-1])
    assert isinstance(inspection.result, Refusal)
    assert inspection.result.code is RefusalCode.MIRRORED
    (found,) = inspection.views
    assert found.residuals is not None
    assert inspection.aim is None


def test_two_guides_are_both_shown(inspected: Callable[..., Inspection]) -> None:
    inspection = inspected(flat_image(*ALL_PARTS, shift_mm=(35.0, -30.0)))
    assert isinstance(inspection.result, Refusal)
    assert inspection.result.code is RefusalCode.AMBIGUOUS
    assert len(inspection.views) == 2


def test_where_a_ring_is_missing_the_other_is_shown(inspected: Callable[..., Inspection]) -> None:
    inspection = inspected(flat_image(*(ALL_PARTS - {Part.SMALL_RING})))
    assert isinstance(inspection.result, Refusal)
    assert inspection.views or inspection.rings
    assert draw(inspection).size > 0


def test_an_image_without_its_plate_is_shown_as_it_arrived(
    inspected: Callable[..., Inspection], intensifier: CArm
) -> None:
    pixels = flat_image(*ALL_PARTS)
    inspection = inspected(pixels, carm=intensifier)
    assert inspection.balls is None
    assert np.array_equal(inspection.pixels, image_of(pixels).pixels)
    assert draw(inspection).size > 0


def test_an_intensifier_image_is_shown_corrected_with_its_balls(
    inspected: Callable[..., Inspection], intensifier: CArm
) -> None:
    scene: Scene = random_scene(8, "ii")
    inspection = inspected(render(scene, 8).pixels, carm=intensifier)
    assert isinstance(inspection.result, Registration)
    distortion, balls = inspection.result.distortion, inspection.balls
    assert balls is not None
    assert int(balls.kept.sum()) == distortion.balls
    squares = (balls.residual_px[balls.kept] ** 2).sum(axis=1)
    assert np.sqrt(squares.mean()) == pytest.approx(distortion.rms_px)
    corrected = np.array([[500.0, 520.0], [300.0, 700.0], [650.0, 350.0]])
    raw = distortion.raw_from_corrected(corrected)
    original = map_coordinates(image_of(render(scene, 8).pixels).pixels, raw[:, ::-1].T, order=1)
    shown = inspection.pixels[corrected[:, 1].astype(int), corrected[:, 0].astype(int)]
    assert shown == pytest.approx(original, abs=0.005)  # OpenCV's remap knows thirty-seconds of a pixel


def test_where_too_little_of_the_plate_is_seen_its_balls_are_shown(
    inspected: Callable[..., Inspection], intensifier: CArm
) -> None:
    scene = random_scene(8, "ii")
    pixels = render(replace(scene, guides=()), 8).pixels
    pixels[:, 350:] = 0  # a collimator's blade
    inspection = inspected(pixels, carm=intensifier)
    assert isinstance(inspection.result, Refusal)
    assert inspection.result.code is RefusalCode.PLATE_TOO_SPARSE
    assert len(inspection.spots) >= inspection.result.measured
    assert (inspection.spots[:, 0] < 360.0).all()


def test_a_picture_is_a_png_with_the_guide_in_colour(inspected: Callable[..., Inspection]) -> None:
    inspection = inspected(flat_image(*ALL_PARTS))
    picture = draw(inspection)
    decoded = cv2.imdecode(np.frombuffer(png(picture), np.uint8), cv2.IMREAD_COLOR)
    assert np.array_equal(decoded, picture)
    bare = draw(replace(inspection, views=[], rings=[], aim=None))
    assert bare.shape[0] < picture.shape[0]  # nothing to unroll
    assert (bare[60:1000].max(axis=2) == bare[60:1000].min(axis=2)).mean() > (
        picture[60:1000].max(axis=2) == picture[60:1000].min(axis=2)
    ).mean()


def centre_of(brightness: NDArray[np.uint8]) -> tuple[float, float]:
    """Row and column of the brightness' centre of mass."""
    rows, columns = np.indices(brightness.shape)
    return float(np.average(rows, weights=brightness)), float(np.average(columns, weights=brightness))


@pytest.mark.parametrize(("corner", "width_px", "side"), [((0.0, 0.0), 100.0, 400), ((20.5, 30.25), 50.0, 333)])
def test_a_panel_draws_on_the_pixels_that_it_shows(corner: tuple[float, float], width_px: float, side: int) -> None:
    grey = np.zeros((100, 100), np.uint8)
    grey[51, 47] = 255
    panel = Panel(grey, corner, width_px, side)
    marked = Panel(np.zeros_like(grey), corner, width_px, side)
    marked.circles(np.array([[47.0, 51.0]]), 6.0, (0, 0, 255), cv2.FILLED)
    assert centre_of(marked.picture[:, :, 2]) == pytest.approx(centre_of(panel.picture[:, :, 2]), abs=0.2)
