"""An OpenIGTLink reader of its own, by the protocol's text (version 1 and 2 headers); it shares no code with pyigtl."""

import socket
import struct
from dataclasses import dataclass

import numpy as np

_HEADER = struct.Struct(">H12s20sQQQ")
# CRC-64 of ECMA-182, as the protocol asks for, most significant bit first, from zero.
_POLYNOMIAL = 0x42F0E1EBA9EA3693


@dataclass(frozen=True)
class Message:
    """One message, its body checked against its CRC."""

    kind: str
    name: str
    content: bytes

    def matrix(self) -> np.ndarray:
        """TRANSFORM: three columns of the rotation, then the translation, float32."""
        values = np.frombuffer(self.content[:48], ">f4").reshape(4, 3)
        found = np.eye(4)
        found[:3, :] = values.T
        return found

    def text(self) -> str:
        """STRING: encoding, length, bytes."""
        _, length = struct.unpack(">HH", self.content[:4])
        return self.content[4 : 4 + length].decode()

    def pixels(self) -> np.ndarray:
        """IMAGE: one slice of unsigned 16-bit scalars."""
        _, components, scalar, endian, _ = struct.unpack(">HBBBB", self.content[:6])
        columns, rows, slices = struct.unpack(">3H", self.content[6:12])
        assert (components, scalar, slices) == (1, 5, 1)
        return np.frombuffer(self.content[72:], ">u2" if endian == 1 else "<u2").reshape(rows, columns)


def read_message(connection: socket.socket) -> Message:
    """The next message."""
    version, kind, name, _, size, crc = _HEADER.unpack(_exactly(connection, _HEADER.size))
    body = _exactly(connection, size)
    assert crc == _crc64(body)
    content = body
    if version == 2:
        extended, metadata, _ = struct.unpack(">HHI", body[:8])
        content = body[extended : len(body) - metadata if metadata else None]
    return Message(kind.rstrip(b"\0").decode(), name.rstrip(b"\0").decode(), content)


def _exactly(connection: socket.socket, size: int) -> bytes:
    found = bytearray()
    while len(found) < size:
        piece = connection.recv(size - len(found))
        assert piece, "the server hung up"
        found += piece
    return bytes(found)


def _table() -> list[int]:
    values = []
    for byte in range(256):
        value = byte << 56
        for _ in range(8):
            value = (value << 1) ^ _POLYNOMIAL if value >> 63 else value << 1
            value &= 0xFFFFFFFFFFFFFFFF
        values.append(value)
    return values


_CRCS = _table()


def _crc64(content: bytes) -> int:
    value = 0
    for byte in content:
        value = (_CRCS[(value >> 56) ^ byte] ^ (value << 8)) & 0xFFFFFFFFFFFFFFFF
    return value
