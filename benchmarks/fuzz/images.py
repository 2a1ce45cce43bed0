"""Targets: images in every transfer syntax that is taken, and pictures."""

from collections.abc import Callable
from functools import partial
from io import BytesIO

import cv2
import numpy as np
from imagecodecs import jpeg2k_encode, jpeg8_encode, jpegls_encode
from PIL import Image
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.encaps import encapsulate
from pydicom.uid import (
    JPEG2000,
    DeflatedExplicitVRLittleEndian,
    ExplicitVRBigEndian,
    ExplicitVRLittleEndian,
    ImplicitVRLittleEndian,
    JPEG2000Lossless,
    JPEGBaseline8Bit,
    JPEGExtended12Bit,
    JPEGLossless,
    JPEGLosslessSV1,
    JPEGLSLossless,
    JPEGLSNearLossless,
    RLELossless,
    XRayAngiographicImageStorage,
)

from benchmarks.fuzz.mutation import changes_of_bytes, with_right_checksums
from benchmarks.fuzz.target import Input, Outcome
from service.database.json_text import to_text
from service.images.dicom_header import read_header
from service.settings import DicomSettings
from vision.refusal import Refusal
from vision.xray import decode, stored_pixels

_SIDE_PX = 256  # the least that is an image
_DICOM_HEAD, _PICTURE_HEAD = 900, 120  # bytes before the pixels
_ENCODERS: dict[str, Callable[[np.ndarray], bytes]] = {
    JPEGExtended12Bit: jpeg8_encode,
    JPEGLossless: partial(jpeg8_encode, lossless=True, predictor=6),
    JPEGLosslessSV1: partial(jpeg8_encode, lossless=True, predictor=1),
    JPEGLSLossless: jpegls_encode,
    JPEGLSNearLossless: partial(jpegls_encode, level=2),
    JPEG2000Lossless: partial(jpeg2k_encode, codecformat="J2K", reversible=True),
    JPEG2000: partial(jpeg2k_encode, codecformat="J2K", level=60),
}
_UNPACKED = (ExplicitVRLittleEndian, ImplicitVRLittleEndian, DeflatedExplicitVRLittleEndian, ExplicitVRBigEndian)
_OF_12_BITS = (*_UNPACKED, RLELossless, *_ENCODERS)
_SYNTAXES = {8: (JPEGBaseline8Bit, *_OF_12_BITS), 12: _OF_12_BITS}  # by the bits of a pixel


def dicom_images() -> list[Input]:
    """An image of 8 and one of 12 bits in every syntax, read as a receiver and as the image worker read them."""
    files = [_dicom(bits, syntax) for bits, some in _SYNTAXES.items() for syntax in some]
    changes = changes_of_bytes(_DICOM_HEAD, files)
    return [Input(file, changes, _read_dicom) for file in files]


def pictures() -> list[Input]:
    """PNG and TIFF of 8 and 16 bits, packed as they usually are, read as an upload is."""
    eight, sixteen = _shadows().astype(np.uint8), _shadows().astype(np.uint16) * 256
    pngs = [cv2.imencode(".png", values)[1].tobytes() for values in (eight, sixteen)]
    ways = [(values, packing) for values in (eight, sixteen) for packing in (None, "tiff_lzw", "tiff_adobe_deflate")]
    tiffs = [_tiff(values, packing) for values, packing in ways]
    changes = changes_of_bytes(_PICTURE_HEAD, [*pngs, *tiffs])
    # a TIFF's directory stands behind its pixels
    changes_of_tiff = [changes_of_bytes(len(file), tiffs) for file in tiffs]
    return [Input(file, changes, _read_picture, with_right_checksums) for file in pngs] + [
        Input(file, some, _read_picture) for file, some in zip(tiffs, changes_of_tiff, strict=True)
    ]


def _shadows() -> np.ndarray:
    rows, columns = np.mgrid[0:_SIDE_PX, 0:_SIDE_PX]
    return (rows + columns) % 200


def _tiff(values: np.ndarray, packing: str | None) -> bytes:
    file = BytesIO()
    Image.fromarray(values).save(file, "TIFF", compression=packing)
    return file.getvalue()


def _dicom(bits: int, syntax: str) -> bytes:
    values = _shadows().astype(np.uint8) if bits == 8 else _shadows().astype(np.uint16) * 16
    image = Dataset()
    image.file_meta = FileMetaDataset()
    image.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    image.SOPClassUID, image.SOPInstanceUID = XRayAngiographicImageStorage, "1.2.3.4"
    image.PatientID, image.PatientName, image.StudyInstanceUID = "P1", "Doe^Jane", "1.2.3"
    image.Modality, image.PhotometricInterpretation, image.StationName = "XA", "MONOCHROME2", "CARM"
    image.AcquisitionDate, image.AcquisitionTime = "20260102", "030405.678"
    image.Rows, image.Columns, image.SamplesPerPixel, image.PixelRepresentation = _SIDE_PX, _SIDE_PX, 1, 0
    image.BitsAllocated, image.BitsStored, image.HighBit = 8 * values.itemsize, bits, bits - 1
    image.PositionerPrimaryAngle, image.DistanceSourceToDetector = 10.5, 1000.0
    image.ImagerPixelSpacing, image.FieldOfViewDimensions, image.KVP = [0.2, 0.2], 230, 76
    image.PixelData = values.tobytes()
    return _in_syntax(image, values, syntax)


def _written(image: Dataset) -> bytes:
    file = BytesIO()
    image.save_as(file, enforce_file_format=True)
    return file.getvalue()


def _in_syntax(image: Dataset, values: np.ndarray, syntax: str) -> bytes:
    """The image in a file of this transfer syntax."""
    if syntax == RLELossless:
        image.compress(RLELossless, values, generate_instance_uid=False)
    elif syntax in (JPEGBaseline8Bit, *_ENCODERS):
        image.PixelData = encapsulate([bytes(_ENCODERS.get(syntax, jpeg8_encode)(values))])
        image["PixelData"].VR = "OB"
    elif syntax == ExplicitVRBigEndian:
        image.PixelData = values.byteswap().tobytes()
    image.file_meta.TransferSyntaxUID = syntax
    return _written(image)


_SETTINGS = DicomSettings()


def _read_dicom(data: bytes) -> Outcome:
    header, problem = read_header(data, _SETTINGS)
    to_text(header.metadata).encode()
    for text in (header.sop_uid, header.patient_id, header.study_uid):
        assert text is None or "\x00" not in text.encode().decode()
    decoded = decode(data)
    if isinstance(decoded, Refusal):
        return decoded.code if problem is None else f"{problem.code} and {decoded.code}"
    return "taken" if problem is None else problem.code


def _read_picture(data: bytes) -> Outcome:
    stored, decoded = stored_pixels(data), decode(data)
    assert isinstance(stored, Refusal) == isinstance(decoded, Refusal)
    return stored.code if isinstance(stored, Refusal) else "taken"
