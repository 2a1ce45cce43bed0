"""CT files: the same body whatever wrote them, and one clear line where they are no CT."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydicom.uid import generate_uid

from simulator.ct.reading import read_ct
from simulator.ct.volume import CtVolume


def _value_at(volume: CtVolume, point: np.ndarray) -> float:
    index = np.linalg.inv(volume.patient_from_voxel) @ [*point, 1.0]
    return float(volume.hounsfield[tuple(np.rint(index[:3]).astype(int))])


@pytest.mark.parametrize(
    "write",
    [lambda ct, folder: ct.write_nifti(folder / "ct.nii.gz"), lambda ct, folder: ct.write_series(folder / "ct")],
    ids=["nifti", "series"],
)
def test_every_voxel_is_where_it_was_in_the_patient(blob_ct, tmp_path: Path, write: Callable) -> None:
    volume, expected, pose = read_ct(write(blob_ct, tmp_path)), blob_ct.hounsfield, blob_ct.patient_from_voxel
    for index in [(0, 0, 0), (33, 54, 68), (60, 20, 100), (10, 90, 30), (69, 99, 129)]:
        point = pose[:3, :3] @ index + pose[:3, 3]
        assert _value_at(volume, point) == pytest.approx(expected[index], abs=1.1)  # HU, whole ones are stored
        assert volume.holds(point)
    assert not volume.holds(pose[:3, :3] @ [-1.0, 0.0, 0.0] + pose[:3, 3])
    assert not volume.holds(pose[:3, :3] @ [33.0, 54.0, 130.0] + pose[:3, 3])


def _set(**values) -> Callable:
    """Changes the fourth slice."""

    def change(number, one):
        for key, value in values.items() if number == 3 else ():
            if value is None:
                delattr(one, key)
            else:
                setattr(one, key, value)
        return one

    return change


def _tilted(number, one):
    places = np.array(one.ImagePositionPatient, dtype=float)
    one.ImagePositionPatient = list(places + number * 0.8 * np.array(one.ImageOrientationPatient[3:], dtype=float))
    return one


def _jumping(number, one):
    aside = 0.7 * np.array(one.ImageOrientationPatient[:3], dtype=float)
    one.ImagePositionPatient = list(np.array(one.ImagePositionPatient, dtype=float) + aside * (number == 3))
    return one


def _doubled(number, one):
    if number == 3:
        axes = np.array(one.ImageOrientationPatient, dtype=float).reshape(2, 3)
        one.ImagePositionPatient = list(np.array(one.ImagePositionPatient, dtype=float) + 5.0 * np.cross(*axes))
    return one


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda number, one: None if number == 3 else one, "a gap: 10.00 mm instead of 5.00 mm"),
        (_doubled, "two slices lie at the same place"),
        (_tilted, "sheared by 9.1 deg: a tilted gantry"),
        (_jumping, "one is 0.70 mm off"),
        (_set(SeriesInstanceUID=generate_uid()), "mixes 2 series"),
        (_set(Modality="MR"), "is no CT but MR"),
        (_set(NumberOfFrames=2), "many frames"),
        (_set(PixelSpacing=[1.3, 1.1]), "differ in PixelSpacing"),
        (_set(ImageOrientationPatient=[1, 0, 0, 0, 1, 0]), "differ in ImageOrientationPatient"),
        (_set(ImagePositionPatient=None), "has no ImagePositionPatient"),
        (_set(PixelData=None), "cannot be read"),
        (lambda number, one: one if number == 3 else None, "one slice"),
        (lambda _number, _one: None, "no DICOM files"),
    ],
)
def test_series_that_is_no_volume_is_refused_in_one_line(
    small_ct, tmp_path: Path, change: Callable, words: str
) -> None:
    with pytest.raises(ValueError, match=words) as refused:
        read_ct(small_ct.write_series(tmp_path / "ct", change))
    assert len(str(refused.value).splitlines()) == 1


def _sheared(ct):
    pose = ct.patient_from_voxel.copy()
    pose[:3, 0] += 0.2 * pose[:3, 1]
    return replace(ct, patient_from_voxel=pose)


@pytest.mark.parametrize(
    ("write", "words"),
    [
        (lambda ct, file: _sheared(ct).write_nifti(file), "sheared"),
        (lambda ct, file: ct.write_nifti(file, unit="meter"), "counts in meter"),
        (
            lambda ct, file: replace(ct, hounsfield=np.clip(ct.hounsfield, 0.0, 250.0)).write_nifti(file),
            "no Hounsfield units",
        ),
        (lambda ct, file: replace(ct, hounsfield=ct.hounsfield[:1]).write_nifti(file), "two or more voxels"),
        (lambda _, file: file.write_bytes(b"no image" * 100), "no readable NIfTI image"),
        (lambda ct, file: ct.write_nifti(file).write_bytes(file.read_bytes()[:5000]), "no readable NIfTI image"),
    ],
)
def test_nifti_that_is_no_ct_is_refused_in_one_line(small_ct, tmp_path: Path, write: Callable, words: str) -> None:
    file = tmp_path / "ct.nii"
    write(small_ct, file)
    with pytest.raises(ValueError, match=words) as refused:
        read_ct(file)
    assert len(str(refused.value).splitlines()) == 1


def test_nifti_that_does_not_say_how_it_lies_is_refused(small_ct, tmp_path: Path) -> None:
    file = small_ct.write_nifti(tmp_path / "ct.nii")
    header = bytearray(file.read_bytes())
    header[252:256] = b"\0" * 4  # qform_code, sform_code
    file.write_bytes(header)
    with pytest.raises(ValueError, match="does not say how it lies"):
        read_ct(file)


def test_path_without_a_ct_is_refused(tmp_path: Path) -> None:
    (tmp_path / "ct.png").write_bytes(b"")
    with pytest.raises(ValueError, match="neither a NIfTI file"):
        read_ct(tmp_path / "ct.png")
    with pytest.raises(FileNotFoundError, match="no CT at"):
        read_ct(tmp_path / "ct.nii.gz")
