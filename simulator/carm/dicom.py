"""An exposure as a DICOM X-Ray Angiographic image, as a mobile C-arm would store it."""

from dataclasses import dataclass
from datetime import datetime
from typing import Self

import numpy as np
from numpy.typing import NDArray
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, XRayAngiographicImageStorage, generate_uid

from simulator.carm.geometry import Angles

_EXPOSURE_MS = 120
_CURRENT_MA = 12
_KVP = 76
_DOSE_DGY_CM2 = 0.35


@dataclass(frozen=True, slots=True)
class Worklist:
    """Whom the C-arm believes to be imaging."""

    patient_id: str
    patient_name: str
    study_uid: str
    series_uid: str

    @classmethod
    def of(cls, patient_id: str, patient_name: str, study_uid: str) -> Self:
        """An entry with a series of its own."""
        return cls(patient_id, patient_name, study_uid, str(generate_uid(prefix=None)))


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One exposure as the C-arm's own computer knows it: nominal geometry, its own clock."""

    pixels: NDArray[np.uint16]
    angles: Angles
    source_to_image_mm: float
    source_to_patient_mm: float
    pixel_mm: float
    field_of_view_mm: float
    round_field: bool
    number: int
    at: datetime
    dose_share: float  # of a normal exposure


def xa_image(frame: Frame, worklist: Worklist) -> Dataset:
    """The complete image with a SOP instance UID of its own."""
    dataset = Dataset()
    dataset.SOPClassUID = XRayAngiographicImageStorage
    dataset.SOPInstanceUID = generate_uid(prefix=None)
    dataset.file_meta = _file_meta(dataset)
    dataset.SpecificCharacterSet = "ISO_IR 192"
    _identify(dataset, worklist, frame)
    _date(dataset, frame)
    _equip(dataset)
    _describe_beam(dataset, frame)
    _add_pixels(dataset, frame)
    return dataset


def _file_meta(dataset: Dataset) -> FileMetaDataset:
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = dataset.SOPClassUID
    meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    return meta


def _identify(dataset: Dataset, worklist: Worklist, frame: Frame) -> None:
    dataset.PatientName = worklist.patient_name
    dataset.PatientID = worklist.patient_id
    dataset.PatientBirthDate = ""
    dataset.PatientSex = ""
    dataset.StudyInstanceUID = worklist.study_uid
    dataset.StudyID = "1"
    dataset.AccessionNumber = ""
    dataset.ReferringPhysicianName = ""
    dataset.SeriesInstanceUID = worklist.series_uid
    dataset.SeriesNumber = 1
    dataset.Modality = "XA"
    dataset.BodyPartExamined = "LSPINE"  # no paired part: needs no laterality
    dataset.PatientPosition = "HFP"
    dataset.InstanceNumber = frame.number
    dataset.PatientOrientation = ""


def _date(dataset: Dataset, frame: Frame) -> None:
    day, time = frame.at.strftime("%Y%m%d"), frame.at.strftime("%H%M%S.%f")
    for moment in ("Study", "Series", "Acquisition", "Content"):
        setattr(dataset, f"{moment}Date", day)
        setattr(dataset, f"{moment}Time", time)


def _equip(dataset: Dataset) -> None:
    dataset.Manufacturer = "Coaxial"
    dataset.ManufacturerModelName = "Simulated C-arm"
    dataset.StationName = "CARM"
    dataset.DeviceSerialNumber = "1"
    dataset.SoftwareVersions = "1"


def _describe_beam(dataset: Dataset, frame: Frame) -> None:
    dataset.ImageType = ["ORIGINAL", "PRIMARY", "SINGLE PLANE"]
    dataset.LossyImageCompression = "00"
    dataset.PixelIntensityRelationship = "DISP"
    dataset.RadiationSetting = "GR"
    dataset.KVP = _KVP
    dataset.XRayTubeCurrent = _CURRENT_MA
    dataset.ExposureTime = _EXPOSURE_MS
    dataset.Exposure = max(1, round(_CURRENT_MA * _EXPOSURE_MS / 1000.0))
    dataset.ImageAndFluoroscopyAreaDoseProduct = round(_DOSE_DGY_CM2 * frame.dose_share, 4)
    dataset.PositionerMotion = "STATIC"
    dataset.PositionerPrimaryAngle = round(float(np.rad2deg(frame.angles.primary_rad)), 1)
    dataset.PositionerSecondaryAngle = round(float(np.rad2deg(frame.angles.secondary_rad)), 1)
    dataset.DistanceSourceToDetector = frame.source_to_image_mm
    dataset.DistanceSourceToPatient = frame.source_to_patient_mm
    dataset.EstimatedRadiographicMagnificationFactor = round(frame.source_to_image_mm / frame.source_to_patient_mm, 4)
    dataset.ImagerPixelSpacing = [round(frame.pixel_mm, 6)] * 2
    dataset.FieldOfViewShape = "ROUND" if frame.round_field else "RECTANGLE"
    size = round(frame.field_of_view_mm)
    dataset.FieldOfViewDimensions = [size] if frame.round_field else [size, size]


def _add_pixels(dataset: Dataset, frame: Frame) -> None:
    dataset.SamplesPerPixel = 1
    dataset.PhotometricInterpretation = "MONOCHROME2"
    dataset.Rows, dataset.Columns = frame.pixels.shape
    dataset.BitsAllocated = dataset.BitsStored = 16
    dataset.HighBit = 15
    dataset.PixelRepresentation = 0
    dataset.PixelData = frame.pixels.astype("<u2").tobytes()
