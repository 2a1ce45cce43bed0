"""RTDE packets: a uint16 size that counts itself, a uint8 type, a payload; big-endian throughout."""

import asyncio
import struct
from collections.abc import Sequence
from enum import IntEnum

Value = float | int | bool | tuple[float, ...] | tuple[int, ...]

_HEADER = struct.Struct(">HB")

# RTDE type word -> struct code, number of elements
_CODES = {
    "DOUBLE": ("d", 1),
    "VECTOR3D": ("d", 3),
    "VECTOR6D": ("d", 6),
    "INT32": ("i", 1),
    "UINT32": ("I", 1),
    "UINT64": ("Q", 1),
    "UINT8": ("B", 1),
    "BOOL": ("?", 1),
    "VECTOR6INT32": ("i", 6),
}


class PacketType(IntEnum):
    """The type byte."""

    PROTOCOL = 86
    VERSION = 118
    OUTPUTS = 79
    INPUTS = 73
    START = 83
    PAUSE = 80
    DATA = 85
    MESSAGE = 77


class Recipe:
    """The order and types of the fields of one kind of data packet."""

    def __init__(self, number: int, names: Sequence[str], types: Sequence[str]) -> None:
        self.number = number
        self.names = tuple(names)
        self._sizes = tuple(_CODES[word][1] for word in types)
        self._layout = struct.Struct(">B" + "".join(f"{_CODES[word][1]}{_CODES[word][0]}" for word in types))

    def pack(self, values: Sequence[Value]) -> bytes:
        """A data payload: recipe number, then the fields."""
        flat: list[float | int | bool] = []
        for value in values:
            flat.extend(value if isinstance(value, tuple) else (value,))
        return self._layout.pack(self.number, *flat)

    def unpack(self, payload: bytes) -> dict[str, Value]:
        """Field values by name.

        Raises
        ------
        struct.error
            If the payload's length is not the recipe's.
        """
        flat = self._layout.unpack(payload)[1:]
        values: dict[str, Value] = {}
        start = 0
        for name, size in zip(self.names, self._sizes, strict=True):
            values[name] = flat[start] if size == 1 else tuple(flat[start : start + size])
            start += size
        return values


def frame(kind: PacketType, payload: bytes) -> bytes:
    """A whole packet."""
    return _HEADER.pack(_HEADER.size + len(payload), kind) + payload


async def read_frame(reader: asyncio.StreamReader) -> tuple[int, bytes]:
    """Type and payload of the next packet.

    Raises
    ------
    asyncio.IncompleteReadError
        At the end of the connection.
    """
    size, kind = _HEADER.unpack(await reader.readexactly(_HEADER.size))
    return kind, await reader.readexactly(size - _HEADER.size)


def names_in(payload: bytes) -> list[str]:
    """Comma-joined names; clients differ in whether a comma follows the last one."""
    return [name for name in payload.decode("ascii").split(",") if name]
