"""Packets of the controller's RTDE port, asked for and answered within a time that is given."""

import socket
import struct
import time

RTDE_PORT = 30004
PROTOCOL, INPUTS, OUTPUTS, START, DATA = 86, 73, 79, 83, 85
_HEADER = struct.Struct(">HB")
_VERSION = struct.pack(">H", 2)
_TAKEN = b"\x01"


def negotiate(connection: socket.socket, end_s: float) -> bool:
    """Whether the controller speaks version 2; OSError if it does not answer until the monotonic time `end_s`."""
    return ask(connection, PROTOCOL, _VERSION, end_s) == _TAKEN


def ask(connection: socket.socket, kind: int, payload: bytes, end_s: float) -> bytes:
    """Payload of the answer to a packet; OSError as `negotiate`."""
    connection.sendall(_HEADER.pack(_HEADER.size + len(payload), kind) + payload)
    return await_packet(connection, kind, end_s)


def await_packet(connection: socket.socket, kind: int, end_s: float) -> bytes:
    """Payload of the next packet of a kind; the controller's text messages may come between."""
    while True:
        size, found = _HEADER.unpack(_exactly(connection, _HEADER.size, end_s))
        if size < _HEADER.size:
            raise ConnectionError("a packet shorter than its own header")
        payload = _exactly(connection, size - _HEADER.size, end_s)
        if found == kind and payload:
            return payload


def _exactly(connection: socket.socket, count: int, end_s: float) -> bytes:
    """So many bytes; OSError if they do not come in time or the connection ends.

    A controller that goes on and on about something else is out of time as well as one that is silent.
    """
    received = b""
    while len(received) < count:
        left_s = end_s - time.monotonic()
        if left_s <= 0.0:
            raise TimeoutError("no answer in time")
        connection.settimeout(left_s)
        part = connection.recv(count - len(received))
        if not part:
            raise ConnectionError("closed within an answer")
        received += part
    return received
