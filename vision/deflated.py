"""DICOM whose data set is deflated: how much it would become, before a parser inflates it (H31)."""

import zlib

_DEFLATED = b"1.2.840.10008.1.2.1.99"  # the transfer syntax UID
_META_LENGTH = b"\x02\x00\x00\x00UL\x04\x00"  # first element of a file: how long the meta information behind it is
_META_AT = 132  # behind preamble and prefix


def inflates_beyond(data: bytes, limit: int) -> bool:
    """Whether a DICOM file may become more than `limit` bytes; True, too, where one that is deflated cannot be told."""
    if _DEFLATED not in data:
        return False
    begin = _META_AT + len(_META_LENGTH) + 4
    if data[_META_AT : begin - 4] != _META_LENGTH:
        return True
    end = begin + int.from_bytes(data[begin - 4 : begin], "little")
    if _DEFLATED not in data[begin:end]:
        return True
    try:
        return len(zlib.decompressobj(-zlib.MAX_WBITS).decompress(data[end:], limit + 1)) > limit
    except zlib.error:
        return False  # the parser says so
