"""A CT of known content, written as NIfTI and as a DICOM series by the tests' own hand."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import nibabel
import numpy as np
import pytest
from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid
from scipy.spatial.transform import Rotation
from scipy.special import erf

_WATER_PER_MM = 0.01937
_PEAK_HU, _WIDTH_MM = 2200.0, 22.0  # of a Gaussian blob in air
_CUT_MM = _WIDTH_MM * np.sqrt(2.0 * np.log(_PEAK_HU / 50.0))  # where the blob falls below -950 HU, which is air
_SHAPE = (70, 100, 130)  # slices, rows, columns
_STEP_MM = (2.5, 1.3, 1.0)

Change = Callable[[int, FileDataset], FileDataset | None]


@dataclass(frozen=True)
class BlobCt:
    """HU (slices, rows, columns), the grid (4x4, LPS, mm) and the blob's place in the patient."""

    hounsfield: np.ndarray
    patient_from_voxel: np.ndarray
    centre_mm: np.ndarray

    def depths(self, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
        """Optical depth along unit rays (..., 3) from a point, LPS, in closed form."""
        squared = np.sum(np.square(np.cross(rays, self.centre_mm - origin)), axis=-1)
        half_mm = np.sqrt(np.maximum(_CUT_MM**2 - squared, 0.0))
        length_mm = _WIDTH_MM * np.sqrt(2.0 * np.pi) * erf(half_mm / (np.sqrt(2.0) * _WIDTH_MM))
        return _WATER_PER_MM * _PEAK_HU / 1000.0 * np.exp(-squared / (2.0 * _WIDTH_MM**2)) * length_mm

    def write_nifti(self, file: Path, unit: str = "mm") -> Path:
        """Columns first, as NIfTI has them, in RAS, with a slope and an intercept."""
        ras_from_voxel = np.diag([-1.0, -1.0, 1.0, 1.0]) @ self.patient_from_voxel[:, [2, 1, 0, 3]]
        image = nibabel.Nifti1Image(np.rint((self.hounsfield.T + 1024.0) * 10.0).astype(np.int16), ras_from_voxel)
        image.header.set_slope_inter(0.1, -1024.0)
        image.header.set_xyzt_units(unit)
        nibabel.save(image, file)
        return file

    def write_series(self, folder: Path, change: Change = lambda _, one: one) -> Path:
        """Slices under names that say nothing of their order; `change` may alter a slice, or leave it out."""
        folder.mkdir()
        series, count = generate_uid(prefix=None), len(self.hounsfield)
        for number, name in enumerate(np.random.default_rng(1).permutation(count)):
            written = change(number, self._slice(number, series))
            if written is not None:
                written.save_as(folder / f"IM{name:04d}", enforce_file_format=True)
        (folder / "README.TXT").write_text("left by the burning program")
        return folder

    def _slice(self, number: int, series: str) -> FileDataset:
        pose, meta = self.patient_from_voxel, FileMetaDataset()
        steps = np.linalg.norm(pose[:3, :3], axis=0)
        axes = pose[:3, :3] / steps
        meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID = CTImageStorage, generate_uid(prefix=None)
        meta.TransferSyntaxUID = ExplicitVRLittleEndian
        one = FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
        one.SOPClassUID, one.SOPInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID
        one.Modality, one.SeriesInstanceUID, one.InstanceNumber = "CT", series, 1000 - number
        one.Rows, one.Columns = self.hounsfield.shape[1:]
        one.PixelSpacing = [f"{step:.6f}" for step in steps[1:]]
        one.ImageOrientationPatient = [f"{value:.8f}" for value in (*axes[:, 2], *axes[:, 1])]
        one.ImagePositionPatient = [f"{value:.5f}" for value in pose[:3, 3] + number * pose[:3, 0]]
        slope = 0.5 if number % 2 else 1.0  # scanners may choose another one for every slice
        one.RescaleSlope, one.RescaleIntercept, one.RescaleType = slope, -1024, "HU"
        one.BitsAllocated, one.BitsStored, one.HighBit, one.PixelRepresentation = 16, 16, 15, 0
        one.SamplesPerPixel, one.PhotometricInterpretation = 1, "MONOCHROME2"
        one.PixelData = np.rint((self.hounsfield[number] + 1024.0) / slope).astype(np.uint16).tobytes()
        return one


@pytest.fixture(scope="session")
def blob_ct() -> BlobCt:
    """Oblique axes, another step along each; the blob well inside, off the middle and far from the origin."""
    centre_mm = np.array([-35.0, 112.0, -640.0])
    turn = Rotation.from_euler("xyz", [8.0, -12.0, 20.0], degrees=True).as_matrix()
    pose = np.eye(4)
    pose[:3, :3] = turn @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]) * _STEP_MM
    pose[:3, 3] = centre_mm - pose[:3, :3] @ [33.0, 54.0, 68.0]
    index = np.stack(np.meshgrid(*(np.arange(count) for count in _SHAPE), indexing="ij"), axis=-1)
    squared = np.sum(np.square(index @ pose[:3, :3].T + pose[:3, 3] - centre_mm), axis=-1)
    return BlobCt(_PEAK_HU * np.exp(-squared / (2.0 * _WIDTH_MM**2)) - 1000.0, pose, centre_mm)


@pytest.fixture(scope="session")
def small_ct(blob_ct: BlobCt) -> BlobCt:
    """Fewer and coarser voxels, for faults, where content does not matter."""
    first, step = np.array([20, 20, 30]), np.array([2, 4, 4])
    pose = blob_ct.patient_from_voxel.copy()
    pose[:3, 3] += pose[:3, :3] @ first
    pose[:3, :3] *= step
    return BlobCt(blob_ct.hounsfield[20:40:2, 20:80:4, 30:100:4], pose, blob_ct.centre_mm)
