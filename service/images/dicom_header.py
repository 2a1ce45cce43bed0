"""What an image says of itself without decoding a pixel, and whether its bytes are all there (H31)."""

import hashlib
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import pydicom.config
from pydicom import Dataset, dcmread

from service.errors import ErrorCode, ServiceError
from service.settings import DicomSettings
from vision.deflated import inflates_beyond

# Words of DICOM and the keys under which metadata has them.
_TEXTS = {
    "Modality": "modality",
    "AcquisitionDate": "acquisition_date",
    "AcquisitionTime": "acquisition_time",
    "ContentDate": "content_date",
    "ContentTime": "content_time",
    "StationName": "station",
    "PhotometricInterpretation": "photometric_interpretation",
    "SeriesInstanceUID": "series_uid",
}
# JPEG baseline and extended, near-lossless JPEG-LS, JPEG 2000: what may have changed pixels, whatever the image says.
_LOSSY_SYNTAXES = frozenset(f"1.2.840.10008.1.2.4.{one}" for one in (50, 51, 81, 91))
_COUNTS = {"Rows": "rows", "Columns": "columns", "BitsStored": "bits"}
_NUMBERS = {
    "PositionerPrimaryAngle": "positioner_primary_deg",
    "PositionerSecondaryAngle": "positioner_secondary_deg",
    "DistanceSourceToDetector": "source_to_detector_mm",
    "ImageAndFluoroscopyAreaDoseProduct": "dose_area_product_dgy_cm2",
    "ExposureTime": "exposure_time_ms",
    "KVP": "tube_voltage_kv",
}


@dataclass(frozen=True, slots=True)
class DicomHeader:
    """Identity and metadata; `pixel_sha256` is over the pixel data as it was sent."""

    sop_uid: str | None
    patient_id: str | None
    study_uid: str | None
    pixel_sha256: str | None
    metadata: dict[str, Any]


# Else a value that is not as its kind should be is told to standard error, and it may be a patient's name.
pydicom.config.settings.reading_validation_mode = pydicom.config.IGNORE

EMPTY_HEADER = DicomHeader(None, None, None, None, {})


def read_header(
    content: bytes, settings: DicomSettings, *, by_statement: bool = False
) -> tuple[DicomHeader, ServiceError | None]:
    """The header, as far as it can be read, and what is wrong with the image, if anything is.

    Which image it is, where it has no UID, may be said `by_statement` of a person.
    """
    if inflates_beyond(content, settings.max_image_bytes):
        limit = settings.max_image_bytes
        return EMPTY_HEADER, ServiceError(ErrorCode.IMAGE_BYTES_TOO_LARGE, "too many bytes, inflated", limit=limit)
    try:
        dataset = dcmread(BytesIO(content), force=True)
        header = _header(dataset)
        return header, _problem(dataset, header, settings, by_statement)
    except Exception as error:  # noqa: BLE001  pydicom raises whatever hostile bytes lead it to
        return EMPTY_HEADER, ServiceError(ErrorCode.NOT_AN_IMAGE, f"not readable as DICOM ({type(error).__name__})")


def _header(dataset: Dataset) -> DicomHeader:
    metadata: dict[str, Any] = {key: _told(dataset[word].value) for word, key in _TEXTS.items() if _has(dataset, word)}
    metadata |= {key: float(dataset[word].value) for word, key in _NUMBERS.items() if _has(dataset, word)}
    metadata |= {key: int(dataset[word].value) for word, key in _COUNTS.items() if _has(dataset, word)}
    metadata["frames"] = int(dataset.get("NumberOfFrames") or 1)
    metadata["lossy"] = _is_lossy(dataset)
    pixels = dataset.get("PixelData")
    return DicomHeader(
        sop_uid=_text(dataset, "SOPInstanceUID"),
        patient_id=_text(dataset, "PatientID"),
        study_uid=_text(dataset, "StudyInstanceUID"),
        pixel_sha256=hashlib.sha256(pixels).hexdigest() if pixels else None,
        metadata=metadata,
    )


def _problem(dataset: Dataset, header: DicomHeader, settings: DicomSettings, by_statement: bool) -> ServiceError | None:
    rows, columns = header.metadata.get("rows", 0), header.metadata.get("columns", 0)
    pixels = rows * columns * header.metadata["frames"]
    unnamed = header.sop_uid is None and not by_statement
    if not dataset.get("PixelData") or rows <= 0 or columns <= 0 or unnamed:
        return ServiceError(ErrorCode.NOT_AN_IMAGE, "no SOP instance UID, no pixel data, or no size")
    if header.metadata["frames"] != 1:
        return ServiceError(
            ErrorCode.SEVERAL_FRAMES, "a run of several frames", measured=header.metadata["frames"], limit=1
        )
    if pixels > settings.max_pixels:
        return ServiceError(
            ErrorCode.IMAGE_BYTES_TOO_LARGE, "too many pixels", measured=pixels, limit=settings.max_pixels
        )
    if min(rows, columns) < settings.min_side_px:
        return ServiceError(
            ErrorCode.IMAGE_TOO_SMALL,
            "a side is too short, in pixels",
            measured=min(rows, columns),
            limit=settings.min_side_px,
        )
    return _truncation(dataset, pixels)


def _truncation(dataset: Dataset, pixels: int) -> ServiceError | None:
    syntax = getattr(dataset.file_meta, "TransferSyntaxUID", None)
    if syntax is None or syntax.is_encapsulated:
        return None  # only decoding can tell, which the image worker does
    expected = pixels * int(dataset.get("SamplesPerPixel", 1)) * int(dataset.get("BitsAllocated", 8)) // 8
    found = len(dataset.PixelData)
    if found >= expected:
        return None
    return ServiceError(ErrorCode.IMAGE_TRUNCATED, "pixel bytes are missing", measured=found, limit=expected)


def _is_lossy(dataset: Dataset) -> bool:
    """Whether the pixels may not be those of the detector any more; an earlier compression leaves its word behind."""
    syntax = getattr(dataset.file_meta, "TransferSyntaxUID", None)
    return syntax in _LOSSY_SYNTAXES or str(dataset.get("LossyImageCompression", "")) == "01"


def _has(dataset: Dataset, word: str) -> bool:
    return word in dataset and dataset[word].value not in (None, "")


def _text(dataset: Dataset, word: str) -> str | None:
    return _told(dataset[word].value).strip() or None if _has(dataset, word) else None


def _told(value: object) -> str:
    """A value as text; ValueError where it is none that a record can hold: NUL, half a character."""
    text = str(value)
    if "\x00" in text:
        raise ValueError("a text with a NUL")
    text.encode()
    return text
