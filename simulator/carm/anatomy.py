"""The optical depth of a body on the raw pixel grid, computed coarsely, as tissue has no edges of wire sharpness."""

from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from simulator.carm.camera import Camera
from simulator.carm.solids import Solid
from simulator.carm.texture import Texture

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

STEP_PX = 2  # the body is computed for every second pixel, 0.4 mm in the patient
_MARGIN_PX = 30.0  # by which distortion may move a solid's outline


class Anatomy(Protocol):
    """What stands behind the guide; the renderer asks nothing else of it."""

    def depths(self, camera: Camera, source_from_patient: Array, ideal_px: Array) -> Array32:
        """Optical depth (rows, columns) at ideal pixels (rows, columns, 2) of a grid that was raw and regular."""


@dataclass(frozen=True, slots=True)
class Body:
    """Anatomy of solids: bone and soft tissue, each modulated by its textures (texture, sd)."""

    bone: tuple[Solid, ...]
    soft: tuple[Solid, ...]
    bone_textures: tuple[tuple[Texture, float], ...]  # relative to the bone's own depth
    soft_textures: tuple[tuple[Texture, float], ...]  # added optical depth

    def depths(self, camera: Camera, source_from_patient: Array, ideal_px: Array) -> Array32:
        """Optical depth (rows, columns) at ideal pixels (rows, columns, 2) of a grid that was raw and regular."""
        rotation = source_from_patient[:3, :3]
        origin = -rotation.T @ source_from_patient[:3, 3]
        rays = (camera.rays(ideal_px).astype(np.float32) @ rotation.astype(np.float32)).astype(np.float32)
        bone, soft = (_sum(solids, camera, source_from_patient, origin, rays) for solids in (self.bone, self.soft))
        for texture, share in self.bone_textures:
            bone *= 1.0 + np.float32(share) * texture.sample(origin, rays)
        for texture, depth in self.soft_textures:
            soft += np.float32(depth) * texture.sample(origin, rays)
        return bone + soft


def enlarge(depths: Array32, columns: int, rows: int) -> Array32:
    """From the coarse grid to all pixels, cubic."""
    return np.asarray(cv2.resize(depths, (columns, rows), interpolation=cv2.INTER_CUBIC), dtype=np.float32)


def _sum(
    solids: tuple[Solid, ...], camera: Camera, source_from_patient: Array, origin: Array, rays: Array32
) -> Array32:
    total = np.zeros(rays.shape[:2], dtype=np.float32)
    for solid in solids:
        centre = source_from_patient[:3, :3] @ np.array(solid.centre_mm) + source_from_patient[:3, 3]
        window = window_of(centre, solid.reach_mm, camera, rays.shape[:2])
        if window is not None:
            total[window] += solid.depths(origin, rays[window])
    return total


def window_of(centre: Array, reach_mm: float, camera: Camera, shape: tuple[int, ...]) -> tuple[slice, slice] | None:
    """The part of the coarse grid that can see a ball about `centre` (source frame, mm); None if no part of it can."""
    nearest_mm = float(centre[2]) - reach_mm
    if nearest_mm <= 0.0:
        return slice(0, shape[0]), slice(0, shape[1])
    u, v = camera.project(centre)
    radius = reach_mm / nearest_mm * camera.source_to_image_mm / camera.pixel_mm * 1.1 + _MARGIN_PX
    rows, columns = _span(v, radius, shape[0]), _span(u, radius, shape[1])
    return None if rows.start >= rows.stop or columns.start >= columns.stop else (rows, columns)


def _span(middle_px: float, radius_px: float, length: int) -> slice:
    first, last = (middle_px - radius_px) / STEP_PX, (middle_px + radius_px) / STEP_PX + 1.0
    return slice(max(0, int(first)), min(length, max(0, int(last))))
