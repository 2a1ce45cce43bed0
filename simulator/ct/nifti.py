"""CT volumes from NIfTI files."""

import zlib
from pathlib import Path

import nibabel
import numpy as np
from nibabel.filebasedimages import ImageFileError
from nibabel.spatialimages import HeaderDataError

from simulator.ct.volume import CtVolume

_LPS_FROM_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])
_MILLIMETRES = ("mm", "unknown")


def read_nifti(file: Path) -> CtVolume:
    """The volume of a NIfTI file; ValueError in one line where it is none, or does not say how it lies."""
    try:
        image = nibabel.load(file)
        values = np.asarray(image.get_fdata(dtype=np.float32, caching="unchanged"))
    except (ImageFileError, HeaderDataError, OSError, EOFError, TypeError, ValueError, zlib.error) as error:
        reason = str(error).splitlines()[0]
        raise ValueError(f"{file.name} is no readable NIfTI image: {reason}") from None
    if values.ndim == 4 and values.shape[3] == 1:
        values = values[..., 0]
    if image.get_sform(coded=True)[1] == 0 and image.get_qform(coded=True)[1] == 0:
        raise ValueError(f"{file.name} does not say how it lies in the patient (sform and qform codes are 0)")
    unit = image.header.get_xyzt_units()[0]
    if unit not in _MILLIMETRES:
        raise ValueError(f"{file.name} counts in {unit}, not in mm")
    return CtVolume(values, _LPS_FROM_RAS @ np.asarray(image.affine, dtype=np.float64))
