"""Events to a pipe that is full, or that nobody holds any more."""

import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import pytest

from robot.guard.lines import decode_event
from robot.guard.messages import Event, Fault, FaultKind, Phase, Status
from robot.guard.outbox import Outbox

FAULT = Fault(FaultKind.ARM_OFF, 1.0, "off")


def status(sequence: int) -> Status:
    return Status(sequence, 0.0, Phase.IDLE, "c" * 200, True, None, None, False, None)


@dataclass
class Pipe:
    """Both ends; a blocking write would hang the test."""

    reading: int
    writing: int

    def taken(self) -> list[Event]:
        """All that arrived, as whole lines."""
        os.set_blocking(self.reading, False)
        lines = b""
        while part := self._part():
            lines += part
        assert lines.endswith(b"\n") or not lines
        return [decode_event(line) for line in lines.splitlines()]

    def _part(self) -> bytes:
        try:
            return os.read(self.reading, 65536)
        except BlockingIOError:
            return b""


@pytest.fixture
def pipe() -> Iterator[Pipe]:
    pipe = Pipe(*os.pipe())
    yield pipe
    for end in (pipe.reading, pipe.writing):
        with suppress(OSError):  # the test closed it
            os.close(end)


def test_an_event_is_a_line(pipe: Pipe) -> None:
    outbox = Outbox(pipe.writing)
    outbox.put(FAULT)
    outbox.put(status(1))
    assert [type(event) for event in pipe.taken()] == [Fault, Status]
    assert outbox.broken is False


def test_a_full_pipe_drops_statuses_and_keeps_everything_else_whole_and_in_order(pipe: Pipe) -> None:
    outbox = Outbox(pipe.writing)
    for sequence in range(1000):  # far more than the 64 kB that a pipe holds
        outbox.put(status(sequence))
    outbox.put(FAULT)
    outbox.put(status(2000))  # behind what waits already
    assert outbox.broken is False  # somebody may read it yet
    before = pipe_and_rest(pipe, outbox)
    assert isinstance(before[-1], Fault)
    sequences = [event.sequence for event in before[:-1]]
    assert sequences == list(range(len(sequences)))
    assert len(sequences) < 1000
    outbox.put(status(3000))
    assert [event.sequence for event in pipe.taken()] == [3000]


def pipe_and_rest(pipe: Pipe, outbox: Outbox) -> list[Event]:
    os.set_blocking(pipe.reading, False)
    lines = os.read(pipe.reading, 1 << 20)
    outbox.push()
    lines += os.read(pipe.reading, 1 << 20)
    return [decode_event(line) for line in lines.splitlines()]


def test_a_pipe_that_nobody_reads_any_more_is_broken_and_takes_events_all_the_same(pipe: Pipe) -> None:
    outbox = Outbox(pipe.writing)
    os.close(pipe.reading)
    outbox.put(FAULT)
    assert outbox.broken is True
    outbox.put(status(1))  # the guard stops the arm, and goes on until it is at rest
    assert outbox.broken is True
