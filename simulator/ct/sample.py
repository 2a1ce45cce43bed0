"""Writes a CT to try the room with: the procedural spine on an oblique grid, noisy, and the paths planned in it.

python -m simulator.ct.sample FOLDER
coaxial demo --truth FOLDER/truth.toml
"""

import argparse
from collections.abc import Mapping
from pathlib import Path

import nibabel
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator.ct.voxels import scan
from simulator.frames import displacement
from simulator.patient import build_body, build_patient
from simulator.pedicle import Pedicle

Array = NDArray[np.float64]

_SEED = 4
_VOXEL_MM = (1.2, 1.2, 2.0)
_SHAPE = (300, 210, 140)
_MIDDLE_MM = (0.0, -40.0, 0.0)  # of the grid in the patient
_TURN_DEG = (2.0, -3.0, 4.0)
_NOISE_HU = 15.0
_RANGE_HU = (-1024.0, 3071.0)  # of 12 bits
_RAS_FROM_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def patient_from_voxel() -> Array:
    """The sample's grid, 4x4, LPS, mm."""
    turn = Rotation.from_euler("xyz", _TURN_DEG, degrees=True).as_rotvec()
    pose = displacement(np.array(_MIDDLE_MM), turn)
    pose[:3, :3] *= _VOXEL_MM
    pose[:3, 3] -= pose[:3, :3] @ ((np.array(_SHAPE) - 1.0) / 2.0)
    return pose


def write_sample(folder: Path) -> None:
    """The CT as NIfTI, and a truth file that makes it the room's patient."""
    folder.mkdir(parents=True, exist_ok=True)
    pose = patient_from_voxel()
    scanned = scan(build_body(_SEED), pose, _SHAPE).hounsfield
    noisy = scanned + np.random.default_rng(_SEED).normal(0.0, _NOISE_HU, _SHAPE)
    image = nibabel.Nifti1Image(np.rint(np.clip(noisy, *_RANGE_HU)).astype(np.int16), _RAS_FROM_LPS @ pose)
    image.header.set_xyzt_units("mm")
    nibabel.save(image, folder / "spine.nii.gz")
    (folder / "truth.toml").write_text(_plan("spine.nii.gz", build_patient(_SEED).pedicles))


def _plan(file: str, pedicles: Mapping[str, Pedicle]) -> str:
    lines = ["[ct]", f'path = "{file}"']
    for name, pedicle in pedicles.items():
        lines.append(f"[ct.pedicles.{name}]")
        lines.append(f"entry_mm = {np.round(pedicle.entry_in_patient, 3).tolist()}")
        lines.append(f"target_mm = {np.round(pedicle.target_in_patient, 3).tolist()}")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write into the folder that was named; exit status 2 where it cannot be written."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="made where missing")
    folder = parser.parse_args().folder
    try:
        write_sample(folder)
    except OSError as error:
        parser.error(f"{folder}: {error.strerror or error}")


if __name__ == "__main__":
    main()
