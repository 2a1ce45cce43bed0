"""Whether a controller's feedback flows, found out in bounded time: the arm's library waits without one (H21)."""

import socket
import struct
import time

from robot.rtde_frames import DATA, OUTPUTS, RTDE_PORT, START, ask, await_packet, negotiate

_WITHIN_S = 1.0  # for three answers and one reading, which take a few cycles of 8 ms
_RATE_HZ = 125.0
_NAMES = b"timestamp,actual_q,actual_qd,actual_TCP_pose,actual_TCP_speed,actual_TCP_force"
_TAKEN = b"\x01"


def feedback_flows(address: str) -> bool:
    """Whether one whole reading comes in time on a connection of its own.

    The library's constructors hold the interpreter while they wait, for seconds where the controller's bytes trickle;
    this process could send no stop meanwhile.
    """
    end_s = time.monotonic() + _WITHIN_S
    try:
        with socket.create_connection((address, RTDE_PORT), _WITHIN_S) as connection:
            return _reads(connection, end_s)
    except OSError:
        return False


def _reads(connection: socket.socket, end_s: float) -> bool:
    if not negotiate(connection, end_s) or b"NOT_FOUND" in _recipe(connection, end_s):
        return False
    return ask(connection, START, b"", end_s) == _TAKEN and bool(await_packet(connection, DATA, end_s))


def _recipe(connection: socket.socket, end_s: float) -> bytes:
    return ask(connection, OUTPUTS, struct.pack(">d", _RATE_HZ) + _NAMES, end_s)
