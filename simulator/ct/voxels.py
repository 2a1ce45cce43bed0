"""The procedural spine as a CT: a volume of known content, where no patient's may be used."""

import numpy as np
from numpy.typing import NDArray

from simulator.carm.anatomy import Body
from simulator.carm.solids import Solid
from simulator.ct.anatomy import WATER_PER_MM
from simulator.ct.volume import CtVolume

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]


def scan(body: Body, patient_from_voxel: Array, shape: tuple[int, int, int], fineness: int = 2) -> CtVolume:
    """A CT of a body, without noise and textures.

    Parameters
    ----------
    body : Body
        Of solids in the patient frame.
    patient_from_voxel : (4, 4)
        The grid, LPS, mm; it may lie obliquely.
    shape : (l, m, n)
        Its voxels.
    fineness : int
        Points along each axis over which a voxel is the mean.
    """
    fine = patient_from_voxel.copy()
    fine[:3, :3] /= fineness
    fine[:3, 3] -= fine[:3, :3] @ np.full(3, (fineness - 1) / 2.0)
    solids = [(solid, _window(solid, fine)) for solid in (*body.bone, *body.soft)]
    slabs = [_slab(solids, fine, index * fineness, shape, fineness) for index in range(shape[0])]
    return CtVolume(np.stack(slabs) * np.float32(1000.0 / WATER_PER_MM) - np.float32(1000.0), patient_from_voxel)


def _window(solid: Solid, patient_from_fine: Array) -> Array:
    """First and last index (2, 3) of the fine grid that a solid's ball can reach."""
    fine_from_patient = np.linalg.inv(patient_from_fine)
    centre = fine_from_patient[:3, :3] @ np.array(solid.centre_mm) + fine_from_patient[:3, 3]
    reach = solid.reach_mm * np.linalg.norm(fine_from_patient[:3, :3], axis=1)
    return np.array([np.floor(centre - reach), np.ceil(centre + reach)])


def _slab(
    solids: list[tuple[Solid, Array]], fine: Array, first: int, shape: tuple[int, int, int], fineness: int
) -> Array32:
    """Mean attenuation (m, n) of the voxels of one slab."""
    per_mm = np.zeros((fineness, shape[1] * fineness, shape[2] * fineness), dtype=np.float32)
    for solid, (low, high) in solids:
        if low[0] < first + fineness and high[0] >= first:
            rows, columns = (
                slice(int(max(low[axis], 0.0)), int(max(min(high[axis] + 1.0, per_mm.shape[axis]), 0.0)))
                for axis in (1, 2)
            )
            points = _points(fine, slice(first, first + fineness), rows, columns)
            per_mm[:, rows, columns] += np.float32(solid.per_mm) * solid.holds(points)
    split = np.maximum(per_mm, 0.0).reshape(fineness, shape[1], fineness, shape[2], fineness)
    mean: Array32 = split.mean(axis=(0, 2, 4))
    return mean


def _points(fine: Array, *spans: slice) -> Array32:
    """Grid points (l, m, n, 3), LPS, mm."""
    grid = np.meshgrid(*(np.arange(span.start, span.stop, dtype=np.float32) for span in spans), indexing="ij")
    points: Array32 = np.stack(grid, axis=-1) @ fine[:3, :3].T.astype(np.float32) + fine[:3, 3].astype(np.float32)
    return points
