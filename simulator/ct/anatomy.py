"""The optical depth of a CT along the C-arm's rays."""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from simulator.carm.camera import Camera
from simulator.ct.volume import CtVolume

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

# Water at 70 keV, between NIST's 60 and 80 keV (NISTIR 5632). A scanner at 120 kV has about this effective energy,
# so that the definition of the Hounsfield unit leads back to attenuation without a bend at bone.
WATER_PER_MM = 0.01937
_AIR_BELOW_HU = -950.0  # a scanner's air is noisy, and cut off at zero its noise would add up along the ray


@dataclass(frozen=True, slots=True, eq=False)
class CtAnatomy:
    """Attenuation per mm (l, m, n) at the voxels' centres, and where those are (4x4, LPS, mm)."""

    per_mm: Array32
    patient_from_voxel: Array

    def depths(self, camera: Camera, source_from_patient: Array, ideal_px: Array) -> Array32:
        """Line integrals of the attenuation between source and detector.

        Parameters
        ----------
        camera : Camera
        source_from_patient : (4, 4)
            mm.
        ideal_px : (rows, columns, 2)
            Undistorted pixels.

        Returns
        -------
        (rows, columns)
            Optical depth, dimensionless.

        Notes
        -----
        Joseph's method (IEEE Trans. Med. Imaging 1 (1982) 192): each ray is sampled once, bilinearly, in every plane
        of voxels across the axis along which it passes most of them. The voxels must lie before the source.
        """
        voxel_from_source = np.linalg.inv(source_from_patient @ self.patient_from_voxel)
        rays = camera.rays(ideal_px) @ voxel_from_source[:3, :3].T  # voxels per mm
        axis = int(np.argmax(np.abs(rays.mean(axis=(0, 1)))))
        across = [other for other in range(3) if other != axis]
        along = rays[..., axis]
        slopes = [(rays[..., other] / along).astype(np.float32) for other in across]
        start = [float(index) for index in voxel_from_source[:3, 3]]
        total = _sum_planes(_planes(self, axis), start[axis], [start[other] for other in across], slopes)
        return np.asarray(total / np.abs(along), dtype=np.float32)


def anatomy_of(volume: CtVolume) -> CtAnatomy:
    """The attenuation of a CT, cropped to what is not air."""
    body = volume.hounsfield >= _AIR_BELOW_HU
    spans = [np.flatnonzero(body.any(axis=tuple(other for other in range(3) if other != axis))) for axis in range(3)]
    window = tuple(slice(int(span[0]), int(span[-1]) + 1) for span in spans)
    water = np.float32(WATER_PER_MM)
    per_mm = np.where(body[window], water + water / np.float32(1000.0) * volume.hounsfield[window], np.float32(0.0))
    pose = volume.patient_from_voxel.copy()
    pose[:3, 3] += pose[:3, :3] @ [part.start for part in window]
    return CtAnatomy(np.maximum(per_mm, np.float32(0.0)), pose)


@lru_cache(maxsize=1)
def _planes(anatomy: CtAnatomy, axis: int) -> Array32:
    """The voxels (planes, rows, columns) with an axis first; remap needs each plane in one piece."""
    return np.ascontiguousarray(np.moveaxis(anatomy.per_mm, axis, 0))


def _sum_planes(planes: Array32, start: float, beside: list[float], slopes: list[Array32]) -> Array32:
    """Sum over the planes of the value where each ray crosses, from the source's indices and the slopes across."""
    total = np.zeros_like(slopes[0])
    places = [np.empty_like(slope) for slope in slopes]
    for index, plane in enumerate(planes):
        for place, slope, first in zip(places, slopes, beside, strict=True):
            np.multiply(slope, np.float32(index - start), out=place)
            place += np.float32(first)
        total += cv2.remap(plane, places[1], places[0], cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
    return total
