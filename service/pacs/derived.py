"""What every object made of a case says of itself: whose it is, of which study, by which program."""

from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum
from io import BytesIO
from uuid import NAMESPACE_OID, uuid5

from pydicom import Dataset, dcmread
from pydicom.dataset import FileMetaDataset
from pydicom.uid import UID, ExplicitVRLittleEndian
from sqlalchemy.engine import Connection

from service.cases.records import StoredCase
from service.images.store import list_images, original_bytes
from service.version import PRODUCT_VERSION

MANUFACTURER = "Coaxial"
# PS3.3 C.7.1.1, C.7.2.1: of type 2, so they stand in every object, empty where nobody said.
_PATIENT_AND_STUDY = (
    "PatientName",
    "PatientID",
    "PatientBirthDate",
    "PatientSex",
    "StudyDate",
    "StudyTime",
    "StudyID",
    "AccessionNumber",
    "ReferringPhysicianName",
)


class ObjectKind(StrEnum):
    """What is sent; each kind is a series of its own in the study."""

    ANNOTATED_IMAGE = "annotated_image"
    STRUCTURED_REPORT = "structured_report"
    REPORT = "report"


_SERIES_NUMBERS = {ObjectKind.ANNOTATED_IMAGE: 9001, ObjectKind.STRUCTURED_REPORT: 9002, ObjectKind.REPORT: 9003}


@dataclass(frozen=True, slots=True)
class DerivedObject:
    """An object ready to be sent; `content` is a DICOM file."""

    kind: ObjectKind
    sop_class: str
    sop_uid: str
    content: bytes


@dataclass(frozen=True, slots=True)
class Place:
    """Where a derived object stands in its study."""

    kind: ObjectKind
    series_uid: UID
    series_number: int
    sop_uid: UID
    number: int


def place_of(case_id: str, kind: ObjectKind, number: int = 1) -> Place:
    """UIDs that follow from the case: an object made twice, as after a crash, is the same object."""
    return Place(kind, _uid(case_id, kind), _SERIES_NUMBERS[kind], _uid(case_id, kind, str(number)), number)


def identity_of(connection: Connection, case: StoredCase) -> Dataset:
    """Patient and study as the C-arm's newest image of the case has them; without one, as the case was opened."""
    identity = Dataset()
    for name in _PATIENT_AND_STUDY:
        setattr(identity, name, "")
    source = _newest_header(connection, case.id)
    for name in _PATIENT_AND_STUDY:
        if source is not None and source.get(name) is not None:
            setattr(identity, name, source[name].value)
    identity.PatientID, identity.StudyInstanceUID = case.patient_id, case.study_uid
    return identity


def derived_dataset(identity: Dataset, place: Place, sop_class: str, modality: str) -> Dataset:
    """The beginning of an object: SOP common, patient, study, series, equipment."""
    dataset = Dataset()
    dataset.update(identity)
    now = datetime.now(UTC)
    dataset.SpecificCharacterSet = "ISO_IR 192"
    dataset.SOPClassUID, dataset.SOPInstanceUID = sop_class, place.sop_uid
    dataset.Modality, dataset.Manufacturer = modality, MANUFACTURER
    dataset.SoftwareVersions = PRODUCT_VERSION
    dataset.SeriesInstanceUID, dataset.SeriesNumber = place.series_uid, place.series_number
    dataset.InstanceNumber = place.number
    dataset.ContentDate, dataset.ContentTime = now.strftime("%Y%m%d"), now.strftime("%H%M%S.%f")
    return dataset


def as_file(dataset: Dataset) -> bytes:
    """The object as a DICOM file, explicit little endian."""
    if not isinstance(getattr(dataset, "file_meta", None), FileMetaDataset):
        dataset.file_meta = FileMetaDataset()
    dataset.file_meta.MediaStorageSOPClassUID = dataset.SOPClassUID
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    written = BytesIO()
    dataset.save_as(written, enforce_file_format=True)
    return written.getvalue()


def finished(kind: ObjectKind, dataset: Dataset) -> DerivedObject:
    """The object, ready to be queued."""
    return DerivedObject(kind, str(dataset.SOPClassUID), str(dataset.SOPInstanceUID), as_file(dataset))


def _newest_header(connection: Connection, case_id: str) -> Dataset | None:
    for image in list_images(connection, case_id):
        if image.problem is None and image.sop_uid is not None:
            return dcmread(BytesIO(original_bytes(connection, image.id)), stop_before_pixels=True)
    return None


def device_uid(room: str) -> UID:
    """The UID of a room's service as an observer."""
    return _uid("room", room)


def _uid(*words: str) -> UID:
    """PS3.5 B.2: a UID derived from a UUID, here one that is derived from words."""
    return UID(f"2.25.{uuid5(NAMESPACE_OID, '/'.join(words)).int}")
