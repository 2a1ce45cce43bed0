"""DICOM whose data set is deflated: how much it would become, before a parser inflates it (H31)."""

import io
import zlib
from typing import Any

from pydicom.filereader import read_dataset
from pydicom.uid import DeflatedExplicitVRLittleEndian

_DEFLATED = DeflatedExplicitVRLittleEndian.encode()
_META_AT = 132  # behind preamble and prefix, where there are some
_META_GROUP = 0x0002


def inflates_beyond(data: bytes, limit: int) -> bool:
    """Whether a DICOM file may become more than `limit` bytes; True, too, where one that is deflated cannot be told."""
    if _DEFLATED not in data:
        return False
    file = io.BytesIO(data)
    file.seek(_META_AT if data[128:_META_AT] == b"DICM" else 0)
    try:
        # the length that the meta information claims is not believed: neither does the parser
        meta = read_dataset(file, is_implicit_VR=False, is_little_endian=True, stop_when=_is_behind_meta)
        if meta.get("TransferSyntaxUID") != DeflatedExplicitVRLittleEndian:
            return False
        return len(zlib.decompressobj(-zlib.MAX_WBITS).decompress(data[file.tell() :], limit + 1)) > limit
    except Exception:  # noqa: BLE001  pydicom raises whatever hostile bytes lead it to
        return True


def _is_behind_meta(tag: Any, _representation: str | None, _length: int) -> bool:
    return bool(tag.group != _META_GROUP)
