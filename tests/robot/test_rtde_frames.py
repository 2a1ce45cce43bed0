"""Answers of a controller that make no sense, or no end: typed, and in the time that was given (H21)."""

import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import repeat

import pytest

from robot.dashboard import DashboardLink, stop_by_dashboard
from robot.rtde_frames import PROTOCOL, negotiate

_TEXT_MESSAGE = struct.pack(">HB", 64, 77) + b"x" * 61
_WITHIN_S = 0.2
_PATIENCE_S = 20.0  # far above what is asked, far below the tests' own limit


@contextmanager
def _answering(parts: Iterator[bytes]) -> Iterator[socket.socket]:
    """A connection to somebody who sends all of this and nothing more, and hears whatever is asked."""
    ours, theirs = socket.socketpair()

    def answer() -> None:
        with theirs:
            try:
                for part in parts:
                    theirs.sendall(part)
                theirs.shutdown(socket.SHUT_WR)
                while theirs.recv(4096):  # what is asked of somebody who has hung up breaks the pipe
                    pass
            except OSError:
                return

    sending = threading.Thread(target=answer)
    sending.start()
    try:
        with ours:
            yield ours
    finally:
        sending.join()


def _timed(call: Callable[[], object]) -> float:
    started_s = time.monotonic()
    call()
    return time.monotonic() - started_s


@pytest.mark.hazard("H21")
def test_a_controller_that_talks_of_something_else_without_end_is_out_of_time() -> None:
    with _answering(repeat(_TEXT_MESSAGE)) as connection, pytest.raises(TimeoutError):
        negotiate(connection, time.monotonic() + _WITHIN_S)


@pytest.mark.parametrize(
    "answer",
    [b"", b"\x00", struct.pack(">HB", 0, PROTOCOL), struct.pack(">HB", 2, PROTOCOL) + b"\x01", b"\xff\xff" + b"V" * 99],
    ids=["nothing", "half a header", "no length", "shorter than its header", "never whole"],
)
def test_an_answer_that_is_none_is_a_fault_of_the_connection(answer: bytes) -> None:
    with _answering(iter([answer])) as connection, pytest.raises(OSError):
        negotiate(connection, time.monotonic() + _PATIENCE_S)


@pytest.mark.parametrize(("answer", "taken"), [(b"\x01", True), (b"\x00", False), (b"\x01\x01", False)])
def test_the_protocols_version_is_taken_or_not(answer: bytes, taken: bool) -> None:
    packet = _TEXT_MESSAGE + struct.pack(">HB", 3 + len(answer), PROTOCOL) + answer
    with _answering(iter([packet])) as connection:
        assert negotiate(connection, time.monotonic() + _PATIENCE_S) is taken


@pytest.mark.hazard("H18")
def test_a_dashboard_that_talks_without_end_has_not_said_that_it_stopped(monkeypatch) -> None:
    with _answering(repeat(b"y" * 4096)) as connection:
        monkeypatch.setattr(socket, "create_connection", lambda *_: connection)
        assert _timed(lambda: stop_by_dashboard("arm")) < _PATIENCE_S


@pytest.mark.hazard("H17")
def test_a_dashboard_whose_answer_drips_is_waited_for_no_longer_than_one_that_is_silent(monkeypatch) -> None:
    """After the death of a guard this is waited for before the fault is told and the next guard starts."""

    def drops() -> Iterator[bytes]:
        for _ in range(300):
            yield b"y"
            time.sleep(_WITHIN_S / 2)

    with _answering(drops()) as connection:
        monkeypatch.setattr(socket, "create_connection", lambda *_: connection)
        assert _timed(lambda: stop_by_dashboard("arm", _WITHIN_S)) < _PATIENCE_S


@pytest.mark.hazard("H18")
def test_a_dashboard_that_talks_without_end_keeps_no_stop_waiting(monkeypatch) -> None:
    """It never reads what it is sent, either: a stop is five bytes, which always fit."""
    with _answering(repeat(b"y" * 4096)) as first, _answering(repeat(b"y" * 4096)) as second:
        connections = iter([first, second])
        monkeypatch.setattr(socket, "create_connection", lambda *_: next(connections))
        monkeypatch.setattr(socket.socket, "setsockopt", lambda *_: None)  # a pair of sockets is no TCP
        link = DashboardLink("arm")
        assert link.send_stop()
        assert _timed(link.send_stop) < _PATIENCE_S
        link.close()
