"""A CT from wherever it is: a NIfTI file, or a folder with one DICOM series."""

from pathlib import Path

from simulator.ct.nifti import read_nifti
from simulator.ct.series import read_series
from simulator.ct.volume import CtVolume

_NIFTI = (".nii", ".nii.gz")


def read_ct(path: Path) -> CtVolume:
    """The volume at a path; ValueError or OSError in one line where there is none."""
    if path.is_dir():
        return read_series(path)
    if not path.exists():
        raise FileNotFoundError(f"no CT at {path}")
    if not path.name.lower().endswith(_NIFTI):
        raise ValueError(f"{path.name} is neither a NIfTI file (.nii, .nii.gz) nor a folder with a DICOM series")
    return read_nifti(path)
