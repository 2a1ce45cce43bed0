"""The images of `render`, at a third of its time: for thousands of scenes. Noise, field and display are the same."""

import cv2
import numpy as np
from numpy.typing import NDArray

from simulator.carm.anatomy import STEP_PX, Body, enlarge
from simulator.carm.camera import pixel_grid
from simulator.carm.exposing import develop
from simulator.carm.quick_body import quick_body_depths
from simulator.carm.quick_metal import ball_patches, quick_metal_depths
from simulator.carm.render import EMPTY_DEPTH, SUB_PIXELS, RenderedXray, add_housing, in_guide
from simulator.carm.scene import PlacedGuide, Scene
from simulator.carm.told import truth_of

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

_BESIDE_WIRE_PX = 4  # of the band in which a wire is looked for, for the rounding of its outline


def render_quickly(scene: Scene, seed: int) -> RenderedXray:
    """The image of a scene; the seed draws the quantum noise alone."""
    intensity = np.exp(-enlarge(soft_depths(scene), scene.camera.columns, scene.camera.rows))
    for guide in scene.guides:
        shade_metal(intensity, scene, guide)
    if scene.plate is not None:
        u, v, passed = ball_patches(scene.plate, scene.camera, scene.distortion, SUB_PIXELS)
        intensity[v, u] *= passed
    pixels = develop(intensity, scene, np.random.default_rng(seed))
    return RenderedXray(pixels, truth_of(scene))


def soft_depths(scene: Scene) -> Array32:
    """Body and housings, on the coarse grid."""
    ideal = scene.distortion.ideal_from_raw(pixel_grid(scene.camera, STEP_PX))
    total = np.full(ideal.shape[:2], EMPTY_DEPTH, dtype=np.float32)
    if isinstance(scene.body, Body):
        total += quick_body_depths(scene.body, scene.camera, scene.source_from_patient, ideal)
    elif scene.body is not None:
        total += scene.body.depths(scene.camera, scene.source_from_patient, ideal)
    for guide in scene.guides:
        add_housing(total, scene, guide, ideal)
    return total


def shade_metal(intensity: Array32, scene: Scene, guide: PlacedGuide) -> None:
    """Multiply pixels by what wires and bead let through, as a mean over parts of each pixel."""
    v, u = np.nonzero(_band(scene, guide))
    places = (np.stack([u, v], axis=-1)[:, None] + SUB_PIXELS).reshape(-1, 2)
    origin, rays = in_guide(guide, scene.camera.rays(scene.distortion.ideal_from_raw(places)))
    passed = np.exp(-quick_metal_depths(guide.shape, origin, rays)).reshape(-1, len(SUB_PIXELS)).mean(axis=1)
    intensity[v, u] *= passed.astype(np.float32)


def _band(scene: Scene, guide: PlacedGuide) -> NDArray[np.bool_]:
    """Raw pixels that a wire or the bead can cover."""
    camera, pose = scene.camera, guide.source_from_guide
    band = np.zeros((camera.rows, camera.columns), dtype=np.uint8)
    for outline, diameter_mm in guide.shape.metal_outline():
        points = outline @ pose[:3, :3].T + pose[:3, 3]
        if np.all(points[:, 2] > 0.0):
            raw = scene.distortion.raw_from_ideal(camera.project(points))
            shadow_px = diameter_mm * camera.source_to_image_mm / points[:, 2].min() / camera.pixel_mm
            line = [np.rint(np.clip(raw, -1e4, 1e4)).astype(np.int32)]
            cv2.polylines(band, line, isClosed=False, color=(255,), thickness=int(shadow_px) + _BESIDE_WIRE_PX)
    return band > 0
