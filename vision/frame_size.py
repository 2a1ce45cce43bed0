"""The size that a frame's own bytes have: a decoder that believes the header instead makes up pixels (H31)."""

import struct
from collections.abc import Iterator

from pydicom import Dataset
from pydicom.encaps import get_frame
from pydicom.uid import RLELossless

_JPEG, _JPEG_2000 = b"\xff\xd8", b"\xff\x4f\xff\x51"  # how a stream begins
_JPEG_LS = 0xF7  # ISO 14495-1
# Of ISO 10918-1 what DICOM has (PS3.5 8.2.1): baseline, extended and lossless, each of one scan with Huffman codes.
_FRAME_HEADERS = frozenset({0xC0, 0xC1, 0xC3, _JPEG_LS})
_FRAME_HEADER, _SAMPLE_BITS = struct.Struct(">BHHB"), range(2, 17)
_ALONE = frozenset({0x01, *range(0xD0, 0xDA)})  # markers without content, which do not belong before a scan
_FILL, _SCAN, _HUFFMAN_TABLES = 0xFF, 0xDA, 0xC4
_TABLE_HEAD = 17  # bytes: which table it is, and how many codes of each length it has
_AC = 0x10  # of a table's first byte: below it its symbols are sizes of differences, in bits
_LARGEST_DIFFERENCE = 16
_RLE_HEADER = struct.Struct("<16I")  # PS3.5 G.5: how many segments, and where each begins
_RLE_NOTHING = 0x80  # PS3.5 G.3.2: a byte that stands for no pixels; above it the next one is repeated
_PADDING = 1  # bytes: what is kept has an even length


def disagrees(dataset: Dataset, index: int, frames: int) -> bool:
    """Whether a frame is not of the size that the header says, or a compressed one does not say its own."""
    syntax = dataset.file_meta.TransferSyntaxUID
    rows, columns = int(dataset.Rows), int(dataset.Columns)
    sample_bytes = int(dataset.BitsAllocated) // 8
    if not syntax.is_encapsulated:
        return not _fits(len(dataset.PixelData), rows * columns * frames * sample_bytes)
    frame = get_frame(dataset.PixelData, index, number_of_frames=frames)
    if syntax == RLELossless:
        lengths = _rle_lengths(frame)
        return len(lengths) != sample_bytes or not all(_fits(length, rows * columns) for length in lengths)
    return told_size(frame) != (rows, columns)


def _fits(length: int, expected: int) -> bool:
    return expected <= length <= expected + _PADDING


def _rle_lengths(frame: bytes) -> list[int]:
    """Bytes that each segment of a frame becomes, PS3.5 Annex G."""
    count, *starts = _RLE_HEADER.unpack_from(frame)
    ends = [*starts[1:count], len(frame)]
    return [_unpacked_length(frame[start:end]) for start, end in zip(starts[:count], ends, strict=True)]


def _unpacked_length(segment: bytes) -> int:
    length = at = 0
    while at + 1 < len(segment):  # a last byte alone is padding
        count = segment[at]
        if count < _RLE_NOTHING:
            length += min(count + 1, len(segment) - at - 1)
            at += count + 2
        elif count == _RLE_NOTHING:
            at += 1
        else:
            length += 257 - count
            at += 2
    return length


def told_size(frame: bytes) -> tuple[int, int] | None:
    """Rows and columns of a JPEG, JPEG-LS or JPEG 2000 stream; None where its header does not say or makes no sense."""
    if frame[:4] == _JPEG_2000 and len(frame) >= 24:
        right, bottom, left, top = struct.unpack(">4I", frame[8:24])
        return bottom - top, right - left
    return _told_by_jpeg(frame) if frame[:2] == _JPEG else None


def _told_by_jpeg(frame: bytes) -> tuple[int, int] | None:
    size, has_codes = None, False
    for marker, content in _segments(frame):
        if marker == _SCAN:
            return size if has_codes else None
        if marker in _ALONE:
            return None
        if marker in _FRAME_HEADERS:
            size = _size_of_x_ray(content)
        if marker == _HUFFMAN_TABLES and not _are_codes(content):
            return None
        has_codes |= marker in (_HUFFMAN_TABLES, _JPEG_LS)
    return None


def _segments(frame: bytes) -> Iterator[tuple[int, bytes]]:
    """Marker and content of what stands before the scan, and of the scan's own header."""
    at = 2
    while at + 4 <= len(frame) and frame[at] == _FILL:
        marker, end = frame[at + 1], at + 2 + int.from_bytes(frame[at + 2 : at + 4], "big")
        if marker == _FILL:
            at += 1
            continue
        yield marker, frame[at + 4 : end]
        at = end


def _size_of_x_ray(frame_header: bytes) -> tuple[int, int] | None:
    """Rows and columns; None for more bits than an image has here, or for colours."""
    if len(frame_header) < _FRAME_HEADER.size:
        return None
    bits, rows, columns, components = _FRAME_HEADER.unpack_from(frame_header)
    return (rows, columns) if bits in _SAMPLE_BITS and components == 1 else None


def _are_codes(tables: bytes) -> bool:
    """Whether Huffman tables are whole and leave room for each of their codes, ISO 10918-1 C.2."""
    while tables:
        of_length, room = tables[1:_TABLE_HEAD], 1
        for count in of_length:
            room = 2 * room - count
            if room < 0:
                return False
        symbols = tables[_TABLE_HEAD : _TABLE_HEAD + sum(of_length)]
        is_whole = len(of_length) == _TABLE_HEAD - 1 and len(symbols) == sum(of_length) > 0
        if not is_whole or (tables[0] < _AC and max(symbols) > _LARGEST_DIFFERENCE):
            return False
        tables = tables[_TABLE_HEAD + len(symbols) :]
    return True
