"""CT volumes from a folder that holds one DICOM series."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydicom import Dataset, dcmread
from pydicom.errors import InvalidDicomError
from pydicom.pixels import apply_modality_lut

from simulator.ct.volume import CtVolume

Array = NDArray[np.float64]

_UNEVEN_MM = 0.1  # of a slice's place: files hold decimal numbers, often rounded to hundredths
_SAME_PLACE_MM = 0.01
_NEEDED = (
    "SeriesInstanceUID",
    "Rows",
    "Columns",
    "PixelSpacing",
    "ImageOrientationPatient",
    "ImagePositionPatient",
    "RescaleSlope",
    "RescaleIntercept",
)


def read_series(folder: Path) -> CtVolume:
    """The volume of a folder's CT slices, whatever the files are called.

    Raises
    ------
    ValueError
        In one line: no CT, more than one series, slices of different grids, a gap, a place twice, a tilted gantry.
    """
    slices = [_checked(file, dataset) for file, dataset in _datasets(folder)]
    if not slices:
        raise ValueError(f"{folder.name} holds no DICOM files")
    _check_one_grid(slices)
    axes = np.array(slices[0].ImageOrientationPatient, dtype=np.float64).reshape(2, 3)
    places = np.array([one.ImagePositionPatient for one in slices], dtype=np.float64)
    order = np.argsort(places @ np.cross(*axes))
    places = places[order]
    _check_places(places, np.cross(*axes))
    down_mm, across_mm = (float(size) for size in slices[0].PixelSpacing)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack(
        [(places[-1] - places[0]) / (len(places) - 1), axes[1] * down_mm, axes[0] * across_mm]
    )
    pose[:3, 3] = places[0]
    return CtVolume(np.stack([_hounsfield(slices[index]) for index in order]), pose)


def _datasets(folder: Path) -> list[tuple[Path, Dataset]]:
    """What is DICOM in a folder: viewers and burning programs leave other files beside it."""
    found = []
    for file in sorted(path for path in folder.iterdir() if path.is_file()):
        try:
            dataset = dcmread(file)
        except InvalidDicomError:
            continue
        if "DirectoryRecordSequence" not in dataset:
            found.append((file, dataset))
    return found


def _checked(file: Path, dataset: Dataset) -> Dataset:
    if dataset.get("Modality") != "CT":
        raise ValueError(f"{file.name} is no CT but {dataset.get('Modality', 'of no modality')}")
    if int(dataset.get("NumberOfFrames", 1)) > 1:
        raise ValueError(f"{file.name} holds many frames: only series of single slices are supported")
    missing = [name for name in _NEEDED if dataset.get(name) is None]
    if missing:
        raise ValueError(f"{file.name} has no {', '.join(missing)}")
    return dataset


def _check_one_grid(slices: Sequence[Dataset]) -> None:
    series = {one.SeriesInstanceUID for one in slices}
    if len(series) > 1:
        raise ValueError(f"the folder mixes {len(series)} series: give one of them a folder of its own")
    if len(slices) == 1:
        raise ValueError("the folder holds one slice: a volume needs two or more")
    for name in ("Rows", "Columns", "PixelSpacing", "ImageOrientationPatient"):
        values = np.array([one[name].value for one in slices], dtype=np.float64)
        if np.ptp(values, axis=0).max() > 1e-3:
            raise ValueError(f"the slices differ in {name}: a scout or a reformatted image is among them")


def _check_places(places: Array, normal: Array) -> None:
    """ValueError unless sorted places (n, 3), LPS, mm, follow one another evenly."""
    steps = np.diff(places @ normal)
    if np.min(steps) < _SAME_PLACE_MM:
        raise ValueError(f"two slices lie at the same place, {places[int(np.argmin(steps))].tolist()} mm")
    usual, worst = float(np.median(steps)), int(np.argmax(np.abs(steps - np.median(steps))))
    if abs(steps[worst] - usual) > _UNEVEN_MM:
        raise ValueError(
            f"a gap: {steps[worst]:.2f} mm instead of {usual:.2f} mm after the slice at {places[worst].tolist()} mm"
        )
    even = np.linspace(places[0], places[-1], len(places))
    off_mm = float(np.max(np.linalg.norm(places - even, axis=1)))
    if off_mm > _UNEVEN_MM * 2.0:
        raise ValueError(f"the slices do not lie on one line: one is {off_mm:.2f} mm off")


def _hounsfield(dataset: Dataset) -> NDArray[np.float32]:
    try:
        pixels = dataset.pixel_array
    except (AttributeError, NotImplementedError, RuntimeError, ValueError) as error:
        reason = str(error).splitlines()[0]
        raise ValueError(f"the pixels of slice {dataset.get('InstanceNumber')} cannot be read: {reason}") from None
    return np.asarray(apply_modality_lut(pixels, dataset), dtype=np.float32)
