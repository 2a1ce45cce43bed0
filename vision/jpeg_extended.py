"""JPEG of 12 bits (process 4), which pydicom leaves to a plug-in under the GPL; GDCM decodes it as dcmtk does."""

from functools import cache
from typing import Any

import gdcm
from pydicom.pixels import get_decoder
from pydicom.uid import UID, JPEGExtended12Bit

DECODER_DEPENDENCIES = {JPEGExtended12Bit: ("numpy", "gdcm")}  # pydicom asks a plug-in for this name, and for the next


def is_available(uid: str) -> bool:
    """Whether a transfer syntax is decoded here."""
    return uid in DECODER_DEPENDENCIES


@cache
def add_decoder() -> None:
    """Have pydicom decode it from now on."""
    get_decoder(JPEGExtended12Bit).add_plugin("coaxial", (__name__, "decode_frame"))


def decode_frame(src: bytes, runner: Any) -> bytes:
    """The pixels of one frame, as bytes; ValueError where there are none of the size that the header says."""
    fragment = gdcm.Fragment()
    fragment.SetByteStringValue(src)
    fragments = gdcm.SequenceOfFragments.New()
    fragments.AddFragment(fragment)
    element = gdcm.DataElement(gdcm.Tag(0x7FE0, 0x0010))
    element.SetValue(fragments.__ref__())
    pixels = _image(element, runner).GetBuffer().encode("utf-8", "surrogateescape")
    expected = runner.rows * runner.columns * runner.samples_per_pixel * runner.bits_allocated // 8
    if len(pixels) != expected:
        raise ValueError(f"{len(pixels)} bytes of pixels instead of {expected}")
    return bytes(pixels)


def _image(element: Any, runner: Any) -> Any:
    image = gdcm.Image()
    image.SetNumberOfDimensions(2)
    image.SetDimensions((runner.columns, runner.rows, 1))
    image.SetDataElement(element)
    kind = gdcm.PhotometricInterpretation.GetPIType(str(runner.photometric_interpretation))
    image.SetPhotometricInterpretation(gdcm.PhotometricInterpretation(kind))
    syntax = gdcm.TransferSyntax.GetTSType(str.__str__(UID(runner.transfer_syntax)))
    image.SetTransferSyntax(gdcm.TransferSyntax(syntax))
    stored = runner.bits_stored
    sample = (runner.samples_per_pixel, runner.bits_allocated, stored, stored - 1, runner.pixel_representation)
    image.SetPixelFormat(gdcm.PixelFormat(*sample))
    return image
