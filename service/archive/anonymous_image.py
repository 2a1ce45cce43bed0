"""An image that names nobody: DICOM attributes by a list of what stays (stricter than PS3.15 E.1), pictures anew.

Pixels are not looked at: what a C-arm has burned into them stays.
"""

from collections.abc import Callable
from io import BytesIO

import numpy as np
from PIL import Image
from pydicom import Dataset, dcmread
from pydicom.dataelem import DataElement

Rename = Callable[[str], str]

# Times stay (PS3.15: Retain Longitudinal Temporal Information With Full Dates), for the record is a course of events.
_KEPT = frozenset(
    [
        "SOPClassUID",
        "Modality",
        "ImageType",
        "ConversionType",
        "Manufacturer",
        "ManufacturerModelName",
        "SoftwareVersions",
        "StudyDate",
        "StudyTime",
        "SeriesDate",
        "SeriesTime",
        "AcquisitionDate",
        "AcquisitionTime",
        "ContentDate",
        "ContentTime",
        "BodyPartExamined",
        "PatientPosition",
        "PatientOrientation",
        "SeriesNumber",
        "InstanceNumber",
        "LossyImageCompression",
        "KVP",
        "XRayTubeCurrent",
        "ExposureTime",
        "Exposure",
        "RadiationSetting",
        "ImageAndFluoroscopyAreaDoseProduct",
        "PositionerMotion",
        "PositionerPrimaryAngle",
        "PositionerSecondaryAngle",
        "DistanceSourceToDetector",
        "DistanceSourceToPatient",
        "FieldOfViewShape",
        "FieldOfViewDimensions",
        "ImagerPixelSpacing",
        "PixelSpacing",
        "PixelIntensityRelationship",
        "PixelIntensityRelationshipSign",
        "SamplesPerPixel",
        "PhotometricInterpretation",
        "Rows",
        "Columns",
        "BitsAllocated",
        "BitsStored",
        "HighBit",
        "PixelRepresentation",
        "NumberOfFrames",
        "FrameIncrementPointer",
        "WindowCenter",
        "WindowWidth",
        "RescaleIntercept",
        "RescaleSlope",
        "RescaleType",
        "PixelAspectRatio",
        "SmallestImagePixelValue",
        "LargestImagePixelValue",
        "PixelData",
    ]
)
_UIDS = ("SOPInstanceUID", "StudyInstanceUID", "SeriesInstanceUID")
_METHOD = "Coaxial: listed attributes kept, UIDs and PatientID replaced, all else removed; pixels as they were"
_UNREADABLE = b"removed: not readable, so that nobody can say what stands in it"


def anonymous(content: bytes, person: Rename, uid: Rename) -> bytes:
    """The image's bytes about nobody."""
    try:
        return _dicom(content, person, uid) if content[128:132] == b"DICM" else _picture(content)
    except Exception:  # noqa: BLE001  decoders raise whatever hostile bytes lead them to; such bytes must not leave
        return _UNREADABLE


def _dicom(content: bytes, person: Rename, uid: Rename) -> bytes:
    original = dcmread(BytesIO(content))
    dataset = Dataset()
    for element in original:
        if isinstance(element, DataElement) and element.keyword in _KEPT:
            dataset.add(element)
    for keyword in _UIDS:
        if keyword in original:
            setattr(dataset, keyword, uid(str(original[keyword].value)))
    dataset.PatientID = dataset.PatientName = person(str(original.get("PatientID", "")))
    dataset.PatientBirthDate = dataset.PatientSex = dataset.AccessionNumber = dataset.ReferringPhysicianName = ""
    dataset.PatientIdentityRemoved, dataset.DeidentificationMethod = "YES", _METHOD[:64]
    dataset.file_meta = original.file_meta
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.get("SOPInstanceUID", uid(""))
    file = BytesIO()
    dataset.save_as(file, enforce_file_format=True)
    return file.getvalue()


def _picture(content: bytes) -> bytes:
    """The pixels alone; text chunks and tags are left behind."""
    with Image.open(BytesIO(content), formats=("PNG", "TIFF")) as picture:
        plain = Image.fromarray(np.array(picture))
    file = BytesIO()
    plain.save(file, "PNG")
    return file.getvalue()
