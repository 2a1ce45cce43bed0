"""The pinhole behind every image: focal spot, detector and the rays between them, on the undistorted grid."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Camera:
    """Focal spot in the origin, detector across +z; `source` frame: x along image u, y along image v, mm."""

    source_to_image_mm: float
    pixel_mm: float
    principal_u_px: float
    principal_v_px: float
    rows: int = 1024
    columns: int = 1024

    def project(self, points_in_source: Array) -> Array:
        """Ideal (undistorted) pixels of points before the source.

        Parameters
        ----------
        points_in_source : (..., 3)
            mm, z positive.

        Returns
        -------
        (..., 2)
            (u, v).
        """
        plane = points_in_source[..., :2] / points_in_source[..., 2:]
        return plane * (self.source_to_image_mm / self.pixel_mm) + (self.principal_u_px, self.principal_v_px)

    def detector_mm(self, ideal_px: Array) -> Array:
        """Where ideal pixels (..., 2) are on the detector, mm from the foot of its normal through the source."""
        return (ideal_px - (self.principal_u_px, self.principal_v_px)) * self.pixel_mm

    def rays(self, ideal_px: Array) -> Array:
        """Unit directions (..., 3) in the source frame, from the focal spot to ideal pixels (..., 2)."""
        plane = self.detector_mm(ideal_px)
        depth = np.full((*plane.shape[:-1], 1), self.source_to_image_mm)
        rays = np.concatenate([plane, depth], axis=-1)
        unit: Array = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
        return unit


def pixel_grid(camera: Camera, step: int = 1) -> Array:
    """Raw pixel centres (rows / step, columns / step, 2) as (u, v); with a step, the centres of blocks of pixels."""
    middle = (step - 1) / 2.0
    u, v = np.meshgrid(np.arange(0, camera.columns, step) + middle, np.arange(0, camera.rows, step) + middle)
    return np.stack([u, v], axis=-1)
