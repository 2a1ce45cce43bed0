"""Frames of JPEG, by libjpeg-turbo: whatever it meets becomes an error, where GDCM may end the process (H31).

pydicom itself leaves 12 bits (process 4) to a plug-in under the GPL.
"""

from functools import cache
from typing import Any

from imagecodecs import jpeg8_decode
from pydicom.pixels import get_decoder
from pydicom.uid import JPEGBaseline8Bit, JPEGExtended12Bit, JPEGLossless, JPEGLosslessSV1

PLUGIN = "coaxial"
SYNTAXES = (JPEGBaseline8Bit, JPEGExtended12Bit, JPEGLossless, JPEGLosslessSV1)
# pydicom asks a plug-in for this name, and for the next one.
DECODER_DEPENDENCIES = dict.fromkeys(SYNTAXES, ("numpy", "imagecodecs"))
_END, _PADDING = b"\xff\xd9", b"\x00"


def is_available(uid: str) -> bool:
    """Whether a transfer syntax is decoded here."""
    return uid in DECODER_DEPENDENCIES


@cache
def add_decoders() -> None:
    """Have pydicom know them from now on."""
    for uid in SYNTAXES:
        get_decoder(uid).add_plugin(PLUGIN, (__name__, "decode_frame"))


def decode_frame(src: bytes, runner: Any) -> bytes:
    """The pixels of one frame, each of as many bytes as the header says.

    ValueError for a stream that is cut off, of which the decoder would make up the rest, and for too many bits.
    """
    if not src.rstrip(_PADDING).endswith(_END):
        raise ValueError("the stream has no end")
    pixels = jpeg8_decode(src)
    sample_bytes = runner.bits_allocated // 8
    if pixels.itemsize > sample_bytes:
        raise ValueError(f"pixels of {pixels.itemsize} bytes instead of {sample_bytes}")
    return bytes(pixels.astype(f"<u{sample_bytes}").tobytes())
