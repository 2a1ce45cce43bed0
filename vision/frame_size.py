"""The size that a compressed frame says it has: a decoder that believes the header instead makes up pixels (H31)."""

import struct

from pydicom import Dataset
from pydicom.encaps import get_frame
from pydicom.uid import RLELossless

_JPEG, _JPEG_2000 = b"\xff\xd8", b"\xff\x4f\xff\x51"  # how a stream begins
# Frame headers of ISO 10918-1 (tables, extensions and conditioning lie between them) and of JPEG-LS, ISO 14495-1.
_FRAME_HEADERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC} | {0xF7}
_FILL = 0xFF


def disagrees(dataset: Dataset, index: int, frames: int) -> bool:
    """Whether a compressed frame is not of the header's size, or does not say its own; RLE has none to say."""
    syntax = dataset.file_meta.TransferSyntaxUID
    if not syntax.is_encapsulated or syntax == RLELossless:
        return False
    frame = get_frame(dataset.PixelData, index, number_of_frames=frames)
    return told_size(frame) != (int(dataset.Rows), int(dataset.Columns))


def told_size(frame: bytes) -> tuple[int, int] | None:
    """Rows and columns of a JPEG, JPEG-LS or JPEG 2000 stream; None where it does not say."""
    if frame[:4] == _JPEG_2000 and len(frame) >= 24:
        right, bottom, left, top = struct.unpack(">4I", frame[8:24])
        return bottom - top, right - left
    if frame[:2] != _JPEG:
        return None
    at = 2
    while at + 9 <= len(frame) and frame[at] == _FILL:
        marker = frame[at + 1]
        if marker in _FRAME_HEADERS:
            rows, columns = struct.unpack(">HH", frame[at + 5 : at + 9])
            return rows, columns
        at += 1 if marker == _FILL else 2 + int.from_bytes(frame[at + 2 : at + 4], "big")
    return None
