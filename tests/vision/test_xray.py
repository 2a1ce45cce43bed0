"""Decoding: every format of the contract, and hostile bytes refused before they cost anything."""

import io
import struct
import zlib
from typing import Any

import numpy as np
import pydicom
import pytest
from PIL import Image
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import (
    DeflatedExplicitVRLittleEndian,
    ExplicitVRLittleEndian,
    XRayAngiographicImageStorage,
    generate_uid,
)

from vision.deflated import inflates_beyond
from vision.refusal import Refusal, RefusalCode
from vision.xray import XrayImage, decode

RAMP = np.tile(np.arange(300, dtype=np.uint16), (260, 1))
NOISE = np.random.default_rng(1).integers(0, 65536, (300, 300), dtype=np.uint16)


def picture(values: Any, kind: str = "PNG") -> bytes:
    """The file of an array."""
    out = io.BytesIO()
    Image.fromarray(values).save(out, format=kind)
    return out.getvalue()


def dicom(values: np.ndarray[Any, Any], **changes: Any) -> bytes:
    """A DICOM file of (rows, columns) or (frames, rows, columns) uint16 values of 12 bits."""
    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.file_meta.MediaStorageSOPClassUID = XRayAngiographicImageStorage
    dataset.file_meta.MediaStorageSOPInstanceUID = generate_uid()
    dataset.Modality, dataset.PhotometricInterpretation, dataset.SamplesPerPixel = "XA", "MONOCHROME2", 1
    dataset.Rows, dataset.Columns = values.shape[-2:]
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit, dataset.PixelRepresentation = 16, 12, 11, 0
    if values.ndim == 3:
        dataset.NumberOfFrames = len(values)
    dataset.PixelData = values.astype("<u2").tobytes()
    for name, value in changes.items():
        setattr(dataset, name, value)
    out = io.BytesIO()
    dataset.save_as(out, enforce_file_format=True)
    return out.getvalue()


def png_header(columns: int, rows: int) -> bytes:
    """A PNG that claims a size and holds no pixels worth it."""
    header = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    chunks = b""
    for name, body in ((b"IHDR", header), (b"IDAT", zlib.compress(b"\0")), (b"IEND", b"")):
        chunks += struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
    return b"\x89PNG\r\n\x1a\n" + chunks


def decoded(data: bytes, frame: int | None = None) -> XrayImage:
    """The image, which there must be."""
    image = decode(data, frame)
    assert isinstance(image, XrayImage), image
    return image


@pytest.mark.parametrize("kind", ["PNG", "TIFF"])
@pytest.mark.parametrize(("values", "bits"), [((RAMP % 256).astype(np.uint8), 8), (RAMP * 200, 16)])
def test_pictures_keep_every_grey_value(kind: str, values: np.ndarray[Any, Any], bits: int) -> None:
    image = decoded(picture(values, kind))
    assert image.bits == bits
    assert np.allclose(image.pixels * (2**bits - 1), values, atol=1e-2)


def test_monochrome1_is_turned_so_that_dense_is_dark() -> None:
    bright = decoded(dicom(RAMP))
    dark = decoded(dicom(RAMP, PhotometricInterpretation="MONOCHROME1"))
    assert np.allclose(bright.pixels, RAMP / 4095.0, atol=1e-6)
    assert np.allclose(bright.pixels + dark.pixels, 1.0, atol=1e-6)


@pytest.mark.parametrize("photometric", ["MONOCHROME1", "MONOCHROME2"])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_sign_of_the_values_decides_however_they_are_shown(photometric: str, sign: int) -> None:
    told = decoded(dicom(RAMP, PhotometricInterpretation=photometric, PixelIntensityRelationshipSign=sign))
    expected = RAMP / 4095.0 if sign == 1 else 1.0 - RAMP / 4095.0
    assert np.allclose(told.pixels, expected, atol=1e-6)


def test_a_tiff_in_which_the_least_value_is_white_is_turned() -> None:
    for values, shown in (
        (RAMP * 200, 1.0 - RAMP * 200 / 65535.0),
        ((RAMP % 256).astype(np.uint8), RAMP % 256 / 255.0),
    ):
        out = io.BytesIO()
        Image.fromarray(values).save(out, format="TIFF", tiffinfo={262: 0})  # turns values of 8 bits itself
        assert np.allclose(decoded(out.getvalue()).pixels, shown, atol=1e-5)


def test_the_pixel_size_is_that_of_the_header() -> None:
    assert decoded(picture(RAMP * 200)).pixel_mm is None
    assert decoded(dicom(RAMP)).pixel_mm is None
    assert decoded(dicom(RAMP, ImagerPixelSpacing=[0.35, 0.36])).pixel_mm == 0.36
    assert decoded(dicom(RAMP, ImagerPixelSpacing=[0, 0])).pixel_mm is None
    assert decoded(dicom(RAMP, FieldOfViewDimensions=[150])).pixel_mm == 0.5
    assert decoded(dicom(RAMP, FieldOfViewDimensions=[120, 150], ImagerPixelSpacing=[0.2, 0.2])).pixel_mm == 0.2


@pytest.mark.parametrize("modality", ["XA", "RF", "CR", "DX", "OT"])
def test_every_kind_of_xray_is_taken_whatever_its_class(modality: str) -> None:
    assert isinstance(decode(dicom(RAMP, Modality=modality)), XrayImage)


def test_frames_are_counted_from_one_and_must_be_chosen() -> None:
    data = dicom(np.stack([RAMP, RAMP + 7, RAMP + 14]))
    assert np.allclose(decoded(data, 2).pixels * 4095.0, RAMP + 7, atol=1e-2)
    for frame in (None, 0, 4, -1):
        refusal = decode(data, frame)
        assert isinstance(refusal, Refusal)
        assert refusal.code is RefusalCode.UNSUPPORTED_IMAGE


UNREADABLE = {
    "nothing": b"",
    "text": b"no image at all" * 100,
    "truncated PNG": picture(NOISE)[:20_000],
    "PNG without pixels": png_header(1024, 1024),
    "truncated DICOM": dicom(RAMP)[:5000],
    "DICOM cut in its header": dicom(RAMP)[:200],
    "DICOM without pixels": dicom(RAMP, PixelData=b""),
    "DICOM whose frames are not there": dicom(RAMP, NumberOfFrames=2_000_000_000),
}


@pytest.mark.parametrize("name", UNREADABLE)
def test_broken_bytes_are_unreadable(name: str) -> None:
    refusal = decode(UNREADABLE[name], 2 if "frames" in name else None)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.UNREADABLE_IMAGE
    assert "\n" not in refusal.message
    assert " at 0x" not in refusal.message  # the same file is refused with the same words


UNSUPPORTED = {
    "colour": picture(np.zeros((300, 300, 3), np.uint8)),
    "not numbers": picture(np.full((300, 300), np.nan, np.float32), "TIFF"),
    "one pixel": picture(np.zeros((1, 1), np.uint8)),
    "DICOM of one pixel": dicom(np.zeros((1, 1), np.uint16)),
    "a CT slice": dicom(RAMP, Modality="CT"),
    "colour DICOM": dicom(RAMP, PhotometricInterpretation="RGB", SamplesPerPixel=3),
}


@pytest.mark.parametrize("name", UNSUPPORTED)
def test_what_is_no_xray_image_is_unsupported(name: str) -> None:
    refusal = decode(UNSUPPORTED[name])
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.UNSUPPORTED_IMAGE


@pytest.mark.hazard("H31")
@pytest.mark.parametrize("data", [png_header(10_000, 10_000), dicom(RAMP, Rows=20_000)], ids=["PNG", "DICOM"])
def test_a_hundred_megapixels_are_refused_by_the_header_alone(data: bytes) -> None:
    refusal = decode(data)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.IMAGE_TOO_LARGE
    assert refusal.measured is not None
    assert refusal.limit is not None
    assert refusal.measured > refusal.limit


@pytest.mark.hazard("H31")
@pytest.mark.parametrize("seed", range(40))
def test_flipped_bytes_never_raise(seed: int) -> None:
    rng = np.random.default_rng(seed)
    data = bytearray(dicom(RAMP) if seed % 2 else picture(RAMP * 200))
    for place in rng.integers(0, min(len(data), 1200), 20):
        data[place] = rng.integers(0, 256)
    assert isinstance(decode(bytes(data)), XrayImage | Refusal)


@pytest.mark.parametrize(("greatest", "bits"), [(200, 8), (1000, 10), (4095, 12), (4096, 14), (40_000, 16)])
@pytest.mark.parametrize("kind", ["PNG", "TIFF"])
def test_files_of_16_bits_tell_by_their_values_how_many_they_use(kind: str, greatest: int, bits: int) -> None:
    values = (np.arange(RAMP.size).reshape(RAMP.shape) % (greatest + 1)).astype(np.uint16)
    image = decode(picture(values, kind))
    assert isinstance(image, XrayImage)
    assert image.bits == bits
    assert image.pixels.max() == pytest.approx(greatest / (2.0**bits - 1.0))


def deflated(content: bytes, length: int | None = None) -> bytes:
    """The data set of a file deflated, with whatever length its meta information claims."""
    dataset = pydicom.dcmread(io.BytesIO(content))
    dataset.file_meta.TransferSyntaxUID = DeflatedExplicitVRLittleEndian
    out = io.BytesIO()
    dataset.save_as(out, enforce_file_format=True)
    data = bytearray(out.getvalue())
    if length is not None:
        data[140:144] = length.to_bytes(4, "little")
    return bytes(data)


def test_a_deflated_image_is_measured_before_it_is_inflated() -> None:
    data = deflated(dicom(np.zeros((300, 300), np.uint16)))
    assert len(data) < 2_000
    assert np.all(decoded(data).pixels == 0)
    assert not inflates_beyond(data, 200_000)
    assert inflates_beyond(data, 180_000)


@pytest.mark.hazard("H31")
@pytest.mark.parametrize("length", [0, 60, 300, 2**32 - 1])
@pytest.mark.parametrize("trailer", [b"", zlib.compress(bytes(10))[2:-4]])
def test_a_deflated_image_is_measured_from_where_it_begins_whatever_it_says(length: int, trailer: bytes) -> None:
    data = deflated(dicom(np.zeros((300, 300), np.uint16)), length) + trailer
    assert inflates_beyond(data, 180_000)
    assert inflates_beyond(data[132:] + trailer, 180_000), "without a preamble"


@pytest.mark.hazard("H31")
def test_deflated_bytes_that_are_no_stream_are_not_inflated() -> None:
    data = deflated(dicom(RAMP))
    broken = data[:400] + bytes(len(data) - 400)
    for bad in (broken, data[:150]):
        assert isinstance(decode(bad), Refusal)
