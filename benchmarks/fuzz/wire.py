"""Targets: frames of the held button's WebSocket, replies of the controller, and readings of the arm."""

import socket
import struct
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from itertools import count
from typing import Any
from unittest.mock import patch

import numpy as np
from pydantic import ValidationError
from websockets.exceptions import ProtocolError
from websockets.frames import Frame, Opcode
from websockets.protocol import OPEN
from websockets.server import ServerProtocol

from benchmarks.fuzz.mutation import WORDS, changes_of_bytes, changes_of_text
from benchmarks.fuzz.target import Input, Outcome
from robot.arm_claim import ArmClaim
from robot.dashboard import DashboardLink, stop_by_dashboard
from robot.errors import RobotError
from robot.feedback_probe import feedback_flows
from robot.guard.heartbeat import HeartbeatMonitor
from robot.guard.lines import decode_command, encode
from robot.guard.messages import Heartbeat, Phase, Status
from robot.guard.observer import Observer
from robot.rtde_frames import DATA, INPUTS, OUTPUTS, PROTOCOL, START
from robot.ur5 import UR5
from service.motion.hold import HeartbeatMessage

_BEAT = '{"number":3,"challenge":"0123456789abcdef","held":true}'
_TEXT_MESSAGE = 77
_READINGS = 4
_READING = struct.Struct(
    "<d6d6d6d6d6dd3dIIiI"
)  # time, joints, speeds, pose, its speed, force, payload, its centre, words
_PARKED = (0.0, -1.57, 1.57, -1.57, -1.57, 0.0)
_TOKEN_CHANGES = changes_of_text(WORDS, [_BEAT.encode()])


def hold_frames() -> list[Input]:
    """Heartbeats as text, and as masked frames whose lengths, kinds and masks are wrong."""
    frames = b"".join(
        Frame(opcode, text).serialize(mask=True)
        for opcode, text in ((Opcode.TEXT, _BEAT.encode()), (Opcode.PING, b"p"), (Opcode.BINARY, b"b"))
    )
    return [
        Input(_BEAT.encode(), _TOKEN_CHANGES, _read_text),
        Input(frames, changes_of_bytes(20, [frames]), _read_frames),
    ]


def controller_replies() -> list[Input]:
    """What answers a claim, a look for feedback, and a stop; and readings that a guard looks at."""
    message = _packet(_TEXT_MESSAGE, b"\x05hello\x06source\x01")
    claim = _packet(PROTOCOL, b"\x01") + message + _packet(INPUTS, b"\x01INT32")
    feedback = _packet(PROTOCOL, b"\x01") + _packet(OUTPUTS, b"\x01DOUBLE,VECTOR6D") + _packet(START, b"\x01")
    feedback += message + _packet(DATA, b"\x01" + bytes(56))
    dashboard = b"Connected: Universal Robots Dashboard Server\nStopped\n"
    readings = b"".join(_reading(number) for number in range(_READINGS))
    replies = [claim, feedback, dashboard]
    changes = changes_of_bytes(1 << 16, replies)
    return [
        Input(claim, changes, _read_claim),
        Input(feedback, changes, _read_feedback),
        Input(dashboard, changes, _read_stop),
        Input(readings, changes_of_bytes(1 << 16, [readings, np.full(200, np.nan).tobytes()]), _read_readings),
    ]


def _read_text(data: bytes) -> Outcome:
    """From a text to the guard's line and its judgement of the heartbeat."""
    try:
        beat = HeartbeatMessage.of(data.decode(errors="replace"))
    except ValidationError:
        return "hold: ended"
    sent = decode_command(encode(Heartbeat("permit-1", beat.number, beat.challenge, beat.held)))
    assert isinstance(sent, Heartbeat)
    return f"hold: heard, fresh {HeartbeatMonitor().receive(sent)}"


def _read_frames(data: bytes) -> Outcome:
    protocol = ServerProtocol(state=OPEN, max_size=1_000_000)
    try:
        protocol.receive_data(data)
        protocol.receive_eof()
    except ProtocolError:
        return "frames: protocol broken"
    frames = [frame for frame in protocol.events_received() if isinstance(frame, Frame)]
    for frame in frames:
        if frame.opcode is Opcode.TEXT:
            _read_text(bytes(frame.data))
    return f"frames: {len(frames)} read"


def _packet(kind: int, payload: bytes) -> bytes:
    return struct.pack(">HB", 3 + len(payload), kind) + payload


def _reading(number: int) -> bytes:
    zeros = (0.0,) * 6
    numbers = (number * 0.008, *_PARKED, *zeros, 0.1, 0.2, 0.3, 0.0, 3.14, 0.0, *zeros, *zeros)
    return _READING.pack(*numbers, 1.0, 0.0, 0.0, 0.05, 1, 1, 7, 1)


class _Connection:
    """One to somebody who has said this, and then hangs up."""

    def __init__(self, said: bytes) -> None:
        self._said = said

    def recv(self, most: int) -> bytes:
        part, self._said = self._said[:most], self._said[most:]
        return part

    def __enter__(self) -> "_Connection":
        return self

    def __exit__(self, *_: object) -> None: ...

    def __getattr__(self, _name: str) -> Callable[..., None]:
        return lambda *_: None  # to send, to close, to set a time limit


def _connected_to(said: bytes) -> AbstractContextManager[object]:
    return patch.object(socket, "create_connection", lambda *_: _Connection(said))


def _read_claim(data: bytes) -> Outcome:
    claim = ArmClaim("arm")
    with _connected_to(data):
        try:
            claim.take()
        except RobotError as refusal:
            return f"claim: {refusal.code}"
    return "claim: taken"


def _read_feedback(data: bytes) -> Outcome:
    with _connected_to(data):
        return f"feedback: {feedback_flows('arm')}"


def _read_stop(data: bytes) -> Outcome:
    link = DashboardLink("arm")
    with _connected_to(data):
        told = stop_by_dashboard("arm")
        return f"stop: written {link.send_stop() and link.send_stop()}, told {told}"


class _Receiver:
    """The arm's library, with readings of any numbers."""

    def __init__(self, data: bytes) -> None:
        whole = len(data) // _READING.size * _READING.size
        self._readings = _READING.iter_unpack(data[:whole])
        self._numbers: tuple[Any, ...] = _READING.unpack(_reading(0))

    def isConnected(self) -> bool:  # noqa: N802  the library's name
        return True

    def getTimestamp(self) -> float:  # noqa: N802
        return float(self._numbers[0])

    def advance(self) -> bool:
        """Take the next reading; False where there is none."""
        numbers = next(self._readings, None)
        self._numbers = numbers or self._numbers
        return numbers is not None

    def __getattr__(self, name: str) -> Callable[[], Any]:
        return lambda: self._told(name)

    def _told(self, name: str) -> Any:
        if name in _PARTS:
            first, size = _PARTS[name]
            return list(self._numbers[first : first + size])
        return self._numbers[_WORDS[name]]


_PARTS = {
    "getActualQ": (1, 6),
    "getActualQd": (7, 6),
    "getActualTCPPose": (13, 6),
    "getActualTCPSpeed": (19, 6),
    "getActualTCPForce": (25, 6),
    "getPayloadCog": (32, 3),
}
_WORDS = {"getPayload": 31, "getSafetyStatusBits": 35, "getRobotStatus": 36, "getRobotMode": 37, "getRuntimeState": 38}


def _read_readings(data: bytes) -> Outcome:
    """Every reading seen by the guard's observer, and what a status would say of it."""
    receiver = _Receiver(data)
    arm = UR5("arm")
    arm._receive = receiver  # type: ignore[assignment]  # as the library's own after a connection
    observer, good, sequence = Observer(arm), 0, count()
    with np.errstate(all="ignore"):
        for now_s in _times(receiver):
            good += observer.read() is not None
            fault, newest = observer.fault(now_s), observer.newest
            encode(Status(next(sequence), now_s, Phase.IDLE, "c", fault is None, newest, None, False, None))
    return f"readings: {good} good"


def _times(receiver: _Receiver) -> Iterator[float]:
    now_s = 0.0
    while receiver.advance():
        yield now_s
        now_s += 0.008
