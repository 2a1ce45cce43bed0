"""A CT on a regular, rectangular grid in the patient."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

_FEWEST_VOXELS = 2  # along an axis: one slice has no thickness of its own
_LARGEST_SKEW = 0.002  # cosine between two axes, 0.1 deg: positions in files are rounded, a tilted gantry is not
_FAT_HU, _BONE_HU = -50.0, 300.0  # every body has values beyond both; an MRI or a label map has not


@dataclass(frozen=True, slots=True, eq=False)
class CtVolume:
    """Hounsfield units at the voxels' centres.

    Parameters
    ----------
    hounsfield : (l, m, n)
        HU, axes as they were stored.
    patient_from_voxel : (4, 4)
        From the indices of a voxel to its centre, DICOM patient coordinates (LPS), mm.

    Raises
    ------
    ValueError
        In one line: too few voxels, axes that are not perpendicular, values that cannot be Hounsfield units.
    """

    hounsfield: Array32
    patient_from_voxel: Array

    def __post_init__(self) -> None:
        """Check what every later step takes for granted."""
        if self.hounsfield.ndim != 3 or min(self.hounsfield.shape) < _FEWEST_VOXELS:
            raise ValueError(f"a CT needs two or more voxels along three axes, not {self.hounsfield.shape}")
        _check_axes(self.patient_from_voxel[:3, :3])
        lowest, highest = float(self.hounsfield.min()), float(self.hounsfield.max())
        if not (lowest < _FAT_HU and highest > _BONE_HU):
            raise ValueError(f"values from {lowest:g} to {highest:g} are no Hounsfield units of a body with bone")

    def holds(self, point_in_patient: Array) -> bool:
        """Whether a point (3,), LPS, mm, is inside the grid."""
        rotation, origin = self.patient_from_voxel[:3, :3], self.patient_from_voxel[:3, 3]
        index = np.linalg.solve(rotation, point_in_patient - origin)
        return bool(np.all(index > -0.5) and np.all(index < np.array(self.hounsfield.shape) - 0.5))


def _check_axes(axes: Array) -> None:
    lengths = np.linalg.norm(axes, axis=0)
    if not np.all(np.isfinite(axes)) or np.min(lengths) <= 0.0:
        raise ValueError("the CT does not say where its voxels are")
    cosines = np.abs(np.triu((axes / lengths).T @ (axes / lengths), 1))
    if np.max(cosines) > _LARGEST_SKEW:
        off_deg = np.rad2deg(np.arcsin(min(1.0, float(np.max(cosines)))))
        raise ValueError(f"the slices are sheared by {off_deg:.1f} deg: a tilted gantry is not supported")
