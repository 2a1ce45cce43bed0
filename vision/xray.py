"""Images from bytes: PNG, TIFF and DICOM, bounded before they are decoded (H31).

Whatever arrives here is hostile until proved otherwise: sizes are read from the header before a pixel is decoded, and
every fault of a decoder becomes a typed refusal.
"""

import hashlib
import io
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import pydicom
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError
from PIL.TiffImagePlugin import TiffImageFile
from pydicom.pixels import pixel_array
from pydicom.uid import JPEG2000, JPEG2000Lossless, JPEGLSLossless, JPEGLSNearLossless

from vision.deflated import inflates_beyond
from vision.frame_size import disagrees
from vision.jpeg import PLUGIN, SYNTAXES, add_decoders
from vision.refusal import Refusal, RefusalCode

LEAST_SIDE_PX = 256  # below it the wires of a 9 inch field are thinner than a pixel
GREATEST_SIDE_PX = 4096
GREATEST_BYTES = 256 * 1024 * 1024
_DEPTHS = (8, 10, 12, 14, 16)  # bits of detectors; files of 16 hold any of them
_DICOM_MAGIC = b"DICM"
_XRAY_MODALITIES = frozenset({"XA", "RF", "CR", "DX", "OT"})
_POLARITIES = frozenset({"MONOCHROME1", "MONOCHROME2"})
_PICTURE_FORMATS = ("PNG", "TIFF")
# Over damaged streams the other decoders make seconds of work (JPEG-LS) or end the process (JPEG, JPEG 2000).
_DECODERS = {
    **dict.fromkeys(SYNTAXES, PLUGIN),
    **dict.fromkeys((JPEGLSLossless, JPEGLSNearLossless), "gdcm"),
    **dict.fromkeys((JPEG2000Lossless, JPEG2000), "pillow"),
}
_TIFF_PHOTOMETRIC = 262  # tag; 0: the least value is white
_PICTURE_BITS = {"L": 8, "I;16": 16, "I;16B": 16, "I;16L": 16}


@dataclass(frozen=True, slots=True, eq=False)
class XrayImage:
    """One decoded X-ray image.

    Attributes
    ----------
    pixels : NDArray[np.float32]
        (rows, columns), dark where the beam was absorbed, 0 to 1 of the range of `bits`.
    bits : int
        Bits that the pixels use: 12 bits are often kept in files of 16.
    sha256 : str
        Of the bytes as they arrived.
    pixel_mm : float or None
        Size of a pixel at the detector, where the file tells it.
    """

    pixels: NDArray[np.float32]
    bits: int
    sha256: str
    pixel_mm: float | None = None

    @property
    def rows(self) -> int:
        """Height in pixels."""
        return int(self.pixels.shape[0])

    @property
    def columns(self) -> int:
        """Width in pixels."""
        return int(self.pixels.shape[1])


@dataclass(frozen=True, slots=True, eq=False)
class _Stored:
    """Values (rows, columns) as a file holds them; `dense_is_bright` where less beam is a greater value."""

    values: NDArray[Any]
    bits: int
    dense_is_bright: bool
    pixel_mm: float | None = None


def decode(data: bytes, frame: int | None = None) -> XrayImage | Refusal:
    """The X-ray image in a file's bytes.

    Parameters
    ----------
    data : bytes
        A PNG or TIFF of 8 or 16 bits, or a DICOM file (XA, RF, CR, DX, SC; MONOCHROME1 or 2).
    frame : int or None
        Which frame of a DICOM image, from 1; needed where there are several.

    Returns
    -------
    XrayImage or Refusal
        `unreadable_image` for what no decoder takes, `unsupported_image` for what is no X-ray image of these kinds,
        `image_too_large` beyond the size limits.
    """
    if len(data) > GREATEST_BYTES:
        return Refusal(RefusalCode.IMAGE_TOO_LARGE, "the file's size in bytes", len(data), GREATEST_BYTES)
    is_dicom = data[128:132] == _DICOM_MAGIC
    if is_dicom and inflates_beyond(data, GREATEST_BYTES):
        return Refusal(RefusalCode.IMAGE_TOO_LARGE, "the file, inflated: its size in bytes", None, GREATEST_BYTES)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # decoders warn of oddities that the checks here decide upon
        stored = _decode_dicom(data, frame) if is_dicom else _decode_picture(data, frame)
    if isinstance(stored, Refusal):
        return stored
    values, bits = stored.values, stored.bits
    if bits == _DEPTHS[-1]:
        bits = next(depth for depth in _DEPTHS if values.max() < 2**depth)
    pixels = values.astype(np.float32) / np.float32(2**bits - 1)
    shown = 1.0 - pixels if stored.dense_is_bright else pixels
    return XrayImage(shown, bits, hashlib.sha256(data).hexdigest(), stored.pixel_mm)


def stored_pixels(data: bytes) -> NDArray[Any] | Refusal:
    """The grey values (rows, columns) of a PNG or TIFF, uint8 or uint16, dark where dense; refused as by `decode`."""
    if len(data) > GREATEST_BYTES:
        return Refusal(RefusalCode.IMAGE_TOO_LARGE, "the file's size in bytes", len(data), GREATEST_BYTES)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # as above
        stored = _decode_picture(data, None)
    if isinstance(stored, Refusal):
        return stored
    values = stored.values
    return np.iinfo(values.dtype).max - values if stored.dense_is_bright else values


def _decode_picture(data: bytes, frame: int | None) -> _Stored | Refusal:
    if frame not in (None, 1):
        return Refusal(RefusalCode.UNSUPPORTED_IMAGE, "frames are chosen in DICOM images only", frame, 1)
    try:
        with Image.open(io.BytesIO(data), formats=_PICTURE_FORMATS) as picture:
            columns, rows = picture.size
            refusal = _check_size(rows, columns)
            if refusal is not None:
                return refusal
            bits = _PICTURE_BITS.get(picture.mode)
            if bits is None:
                return _unsupported(f"pixels of mode {picture.mode}; 8 or 16 bit grey values are needed")
            # of 16 bits Pillow hands out what the file holds, of 8 it turns the polarity itself
            white_is_zero = bits > 8 and _tiff_tag(picture, _TIFF_PHOTOMETRIC) == 0
            return _Stored(np.array(picture), bits, white_is_zero)
    except UnidentifiedImageError:  # its words name an object in memory
        return Refusal(RefusalCode.UNREADABLE_IMAGE, "the bytes are no readable image: neither DICOM, PNG nor TIFF")
    except (OSError, ValueError, SyntaxError, OverflowError, MemoryError, Image.DecompressionBombError) as error:
        return _unreadable(error)


def _tiff_tag(picture: Image.Image, tag: int) -> Any:
    return picture.tag_v2.get(tag) if isinstance(picture, TiffImageFile) else None


def _decode_dicom(data: bytes, frame: int | None) -> _Stored | Refusal:
    try:
        dataset = pydicom.dcmread(io.BytesIO(data))
        return _dicom_pixels(dataset, frame)
    # pydicom and its plug-ins raise whatever their parsers meet in hostile bytes; all of it means "unreadable"
    except Exception as error:  # noqa: BLE001  see above
        return _unreadable(error)


def _dicom_pixels(dataset: Any, frame: int | None) -> _Stored | Refusal:
    refusal = _check_dicom_header(dataset)
    if refusal is not None:
        return refusal
    frames = int(dataset.get("NumberOfFrames", 1) or 1)
    chosen = 1 if frame is None else frame
    if (frame is None and frames > 1) or not 1 <= chosen <= frames:
        return Refusal(RefusalCode.UNSUPPORTED_IMAGE, f"choose one of {frames} frames with --frame", frame, frames)
    if disagrees(dataset, chosen - 1, frames):
        return Refusal(RefusalCode.UNREADABLE_IMAGE, "the pixels are not of the size that the header says")
    add_decoders()
    values = pixel_array(
        dataset, index=chosen - 1, decoding_plugin=_DECODERS.get(dataset.file_meta.TransferSyntaxUID, "")
    )
    bits = int(dataset.BitsStored)
    if int(dataset.PixelRepresentation):
        values = values.astype(np.int32) + 2 ** (bits - 1)
    return _Stored(np.clip(values, 0, 2**bits - 1), bits, _dense_is_bright(dataset), _told_pixel_mm(dataset))


def _dense_is_bright(dataset: Any) -> bool:
    """Whether greater values mean less beam: PS3.3 C.8.11.3.1.2 says it; without that, what is shown dark is dense."""
    sign = dataset.get("PixelIntensityRelationshipSign")
    return bool(dataset.PhotometricInterpretation == "MONOCHROME1") if sign is None else int(sign) < 0


def _told_pixel_mm(dataset: Any) -> float | None:
    """A pixel's size at the detector: by its spacing, else by the field of view; the greater where it is not square."""
    spacing = dataset.get("ImagerPixelSpacing")
    if spacing and max(spacing) > 0:  # zero stands there where a maker does not know
        return float(max(spacing))
    if field := dataset.get("FieldOfViewDimensions"):
        return float(np.max(field)) / max(int(dataset.Rows), int(dataset.Columns))
    return None


def _check_dicom_header(dataset: Any) -> Refusal | None:
    """Modality and pixel format; the SOP class is not asked, since secondary captures of X-rays are usual."""
    if "PixelData" not in dataset:
        return Refusal(RefusalCode.UNREADABLE_IMAGE, "the DICOM file holds no pixels")
    if str(dataset.get("Modality", "")) not in _XRAY_MODALITIES:
        return _unsupported(f"modality {dataset.get('Modality', 'none')!s}; an X-ray image is needed")
    if dataset.get("PhotometricInterpretation") not in _POLARITIES or int(dataset.get("SamplesPerPixel", 1)) != 1:
        return _unsupported(f"pixels are {dataset.get('PhotometricInterpretation', 'of no kind')!s}; grey is needed")
    return _check_size(int(dataset.Rows), int(dataset.Columns))


def _check_size(rows: int, columns: int) -> Refusal | None:
    if max(rows, columns) > GREATEST_SIDE_PX:
        message = f"the image is {columns} x {rows} pixels: its longer side"
        return Refusal(RefusalCode.IMAGE_TOO_LARGE, message, max(rows, columns), GREATEST_SIDE_PX)
    if min(rows, columns) < LEAST_SIDE_PX:
        message = f"the image is {columns} x {rows} pixels: its shorter side"
        return Refusal(RefusalCode.UNSUPPORTED_IMAGE, message, min(rows, columns), LEAST_SIDE_PX)
    return None


def _unsupported(message: str) -> Refusal:
    return Refusal(RefusalCode.UNSUPPORTED_IMAGE, message)


def _unreadable(error: BaseException) -> Refusal:
    reason = (str(error).splitlines() or [type(error).__name__])[0][:200]
    return Refusal(RefusalCode.UNREADABLE_IMAGE, f"the bytes are no readable image: {reason}")
