"""A second RTDE client, written from the protocol's description alone: it shares no code with ur-rtde or the fake.

Names are sent without a trailing comma, types are taken from the controller's answer, and the recipes' ids as well.
"""

import socket
import struct
from typing import Any, Self

RTDE_PORT = 30004
_LAYOUTS = {
    "DOUBLE": "d",
    "VECTOR3D": "3d",
    "VECTOR6D": "6d",
    "INT32": "i",
    "UINT32": "I",
    "UINT64": "Q",
    "UINT8": "B",
    "BOOL": "?",
    "VECTOR6INT32": "6i",
}


class InUseError(Exception):
    """Another client writes one of the inputs."""


class RtdeClient:
    """One connection; messages of the controller that nobody asked for are skipped."""

    def __init__(self, address: str, timeout_s: float = 5.0) -> None:
        self._socket = socket.create_connection((address, RTDE_PORT), timeout_s)
        self._stream = self._socket.makefile("rb")
        self._outputs: list[tuple[str, struct.Struct]] = []
        self._inputs: tuple[int, struct.Struct] | None = None
        assert self._ask(b"V", struct.pack(">H", 2)) == b"\x01", "protocol version 2 is refused"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stream.close()
        self._socket.close()

    def version(self) -> tuple[int, int, int, int]:
        """Major, minor, bug fix and build of the controller."""
        major, minor, fix, build = struct.unpack(">4I", self._ask(b"v", b""))
        return major, minor, fix, build

    def subscribe(self, *names: str, rate_hz: float = 125.0) -> None:
        """Ask for these outputs and start."""
        answer = self._ask(b"O", struct.pack(">d", rate_hz) + ",".join(names).encode())
        self._outputs = list(zip(names, map(_layout, _types(answer)), strict=True))
        assert self._ask(b"S", b"") == b"\x01", "the start is refused"

    def read(self) -> dict[str, Any]:
        """The next packet."""
        payload, place, values = self._next(b"U"), 1, {}
        for name, layout in self._outputs:
            content = layout.unpack_from(payload, place)
            values[name] = content[0] if len(content) == 1 else content
            place += layout.size
        assert place == len(payload), "the packet is not as long as its recipe"
        return values

    def claim(self, *names: str) -> None:
        """Ask for these inputs; InUseError if another client has one of them."""
        answer = self._ask(b"I", ",".join(names).encode())
        if b"IN_USE" in answer:
            raise InUseError(answer[1:].decode())
        codes = "".join(_LAYOUTS[word] for word in _types(answer))
        self._inputs = answer[0], struct.Struct(">B" + codes)

    def write(self, *values: float) -> None:
        """Send the claimed inputs."""
        assert self._inputs is not None
        recipe, layout = self._inputs
        self._send(b"U", layout.pack(recipe, *values))

    def _ask(self, kind: bytes, payload: bytes) -> bytes:
        self._send(kind, payload)
        return self._next(kind)

    def _send(self, kind: bytes, payload: bytes) -> None:
        self._socket.sendall(struct.pack(">H", 3 + len(payload)) + kind + payload)

    def _next(self, wanted: bytes) -> bytes:
        while True:
            header = self._stream.read(3)
            if len(header) < 3:
                raise ConnectionError("the controller closed the connection")
            payload = self._stream.read(int.from_bytes(header[:2], "big") - 3)
            if header[2:] == wanted:
                return payload


def _types(answer: bytes) -> list[str]:
    """Of a recipe; KeyError follows for NOT_FOUND."""
    return answer[1:].decode().split(",")


def _layout(word: str) -> struct.Struct:
    return struct.Struct(">" + _LAYOUTS[word])
