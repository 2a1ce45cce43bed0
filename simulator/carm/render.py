"""X-ray images: Beer-Lambert along straight rays, then the intensifier, the quanta and the display."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from simulator.carm.anatomy import STEP_PX, enlarge, window_of
from simulator.carm.camera import pixel_grid
from simulator.carm.exposing import develop
from simulator.carm.plate import Plate
from simulator.carm.scene import PlacedGuide, Scene
from simulator.carm.told import truth_of

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]
Depths = Callable[[Array], Array]  # optical depth (n,) at ideal pixels (n, 2)

EMPTY_DEPTH = 1.0  # of a scene without a patient: table and housing of the detector
_NEAR_WIRE_PX = 10  # width of the band around a wire's projection that is looked at closely
_AROUND_BALL_PX = 2
SUB_PIXELS = np.array([[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]])


@dataclass(frozen=True, slots=True, eq=False)
class RenderedXray:
    """Pixels (rows, columns), uint8 or uint16, dark = dense, and the truth in the samples' format."""

    pixels: NDArray[np.uint8] | NDArray[np.uint16]
    truth: dict[str, Any]


def render(scene: Scene, seed: int) -> RenderedXray:
    """The image of a scene; the seed draws the quantum noise alone."""
    intensity = np.exp(-enlarge(_soft_depths(scene), scene.camera.columns, scene.camera.rows))
    for guide in scene.guides:
        _shade(intensity, scene, _near_metal(scene, guide), partial(_metal_depths, scene, guide))
    if scene.plate is not None:
        plate = scene.plate
        _shade(intensity, scene, _near_balls(scene, plate), partial(plate.depths, scene.camera))
    pixels = develop(intensity, scene, np.random.default_rng(seed))
    return RenderedXray(pixels, truth_of(scene))


def _soft_depths(scene: Scene) -> Array32:
    """Body and housings, on the coarse grid."""
    ideal = scene.distortion.ideal_from_raw(pixel_grid(scene.camera, STEP_PX))
    total = np.full(ideal.shape[:2], EMPTY_DEPTH, dtype=np.float32)
    if scene.body is not None:
        total += scene.body.depths(scene.camera, scene.source_from_patient, ideal)
    for guide in scene.guides:
        add_housing(total, scene, guide, ideal)
    return total


def add_housing(total: Array32, scene: Scene, guide: PlacedGuide, ideal: Array) -> None:
    """Only where the housing can be: it fills a few per cent of an image."""
    middle, radius = guide.shape.housing_ball()
    centre = guide.source_from_guide[:3, :3] @ middle + guide.source_from_guide[:3, 3]
    window = window_of(centre, radius, scene.camera, total.shape)
    if window is not None:
        origin, rays = in_guide(guide, scene.camera.rays(ideal[window]).reshape(-1, 3))
        total[window] += guide.shape.housing_depths(origin, rays).reshape(total[window].shape).astype(np.float32)


def _near_metal(scene: Scene, guide: PlacedGuide) -> NDArray[np.bool_]:
    """The raw pixels around the projections of wires and bead."""
    band = np.zeros((scene.camera.rows, scene.camera.columns), dtype=np.uint8)
    pose = guide.source_from_guide
    for outline, diameter_mm in guide.shape.metal_outline():
        points = outline @ pose[:3, :3].T + pose[:3, 3]
        if np.all(points[:, 2] > 0.0):
            raw = scene.distortion.raw_from_ideal(scene.camera.project(points))
            shadow_px = diameter_mm * scene.camera.source_to_image_mm / points[:, 2].min() / scene.camera.pixel_mm
            line = [np.rint(np.clip(raw, -1e4, 1e4)).astype(np.int32)]
            cv2.polylines(band, line, isClosed=False, color=(255,), thickness=int(shadow_px) + _NEAR_WIRE_PX)
    return band > 0


def _near_balls(scene: Scene, plate: Plate) -> NDArray[np.bool_]:
    """The raw pixels around the balls' projections."""
    spots = np.zeros((scene.camera.rows, scene.camera.columns), dtype=np.uint8)
    radius = round(plate.ball_diameter_mm / 2.0 / scene.camera.pixel_mm) + _AROUND_BALL_PX
    for u, v in np.rint(scene.distortion.raw_from_ideal(plate.balls_ideal_px(scene.camera))).astype(int).tolist():
        cv2.circle(spots, (u, v), radius, (255,), thickness=cv2.FILLED)
    return spots > 0


def _shade(intensity: Array32, scene: Scene, mask: NDArray[np.bool_], depths: Depths) -> None:
    """Multiply pixels by what metal lets through, as a mean over parts of each pixel."""
    v, u = np.nonzero(mask)
    middles = np.stack([u, v], axis=-1).astype(np.float64)
    passed = np.zeros(len(middles))
    for part in SUB_PIXELS:
        passed += np.exp(-depths(scene.distortion.ideal_from_raw(middles + part)))
    intensity[v, u] *= (passed / len(SUB_PIXELS)).astype(np.float32)


def _metal_depths(scene: Scene, guide: PlacedGuide, ideal_px: Array) -> Array:
    return guide.shape.metal_depths(*in_guide(guide, scene.camera.rays(ideal_px)))


def in_guide(guide: PlacedGuide, rays_in_source: Array) -> tuple[Array, Array]:
    """The focal spot and rays (n, 3) in the guide frame."""
    rotation = guide.source_from_guide[:3, :3]
    return -rotation.T @ guide.source_from_guide[:3, 3], rays_in_source @ rotation
