"""The guard's process, part by part: its pipe, signals, its parent's end, and the process as its parent holds it."""

import io
import os
import resource
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from queue import Empty, SimpleQueue
from types import SimpleNamespace

import pytest

from robot.guard import process
from robot.guard.child import GuardChild
from robot.guard.lines import encode
from robot.guard.messages import Acknowledge, Heartbeat, Phase, ReleasePendant, Stop, StopSent

PATIENCE_S = 20.0
CYCLE_S = 0.008  # of a CB3 controller
BEAT = Heartbeat("permit", 1, "challenge", True)


class Guard:
    """Keeps what it is told; at rest after some turns."""

    def __init__(self, turns: int = 0) -> None:
        self.turns = turns
        self.told: list[object] = []
        self.severed = False

    @property
    def phase(self) -> Phase:
        return Phase.MOVING if self.turns > 0 else Phase.HELD

    def stop_now(self, reason: str) -> StopSent:
        self.told.append(reason)
        return StopSent(reason, 0.0, True)

    def handle(self, taken: object) -> None:
        self.told.append(taken)

    def lose_parent(self) -> None:
        self.told.append("parent lost")

    def tick(self) -> None:
        self.turns -= 1
        self.told.append("tick")


class Ends:
    """Outbox and arm in one: neither broken nor stuck unless it is said."""

    broken = False
    stuck = False
    pushed = 0

    def push(self) -> None:
        self.pushed += 1

    def put(self, event: object) -> None:
        raise AssertionError(event)

    def is_stuck(self) -> bool:
        return self.stuck


def drained(inbox: SimpleQueue) -> list[object]:
    return [inbox.get_nowait() for _ in range(inbox.qsize())]


def test_stops_go_out_before_the_loop_knows_and_the_rest_waits_its_turn() -> None:
    guard, inbox = Guard(), SimpleQueue()
    commands = (BEAT, Stop("asked"), ReleasePendant("access"), Acknowledge())
    process._receive(io.BytesIO(b"".join(map(encode, commands))), guard, inbox)
    assert guard.told == ["asked", "access", "the service is gone"]
    *taken, gone = drained(inbox)
    assert taken == [
        BEAT,
        StopSent("asked", 0.0, True),
        StopSent("access", 0.0, True),
        ReleasePendant("access"),
        Acknowledge(),
    ]
    assert gone is process._Parent.GONE


def test_a_line_that_nobody_understands_is_a_stop() -> None:
    guard, inbox = Guard(), SimpleQueue()
    process._receive(io.BytesIO(b"{}\n"), guard, inbox)
    assert guard.told[0].startswith("not a message of the guard")
    assert [type(taken) for taken in drained(inbox)] == [StopSent, process._Parent]


def test_a_turn_takes_all_that_has_arrived_and_says_whether_the_parent_is_gone() -> None:
    guard, inbox = Guard(), SimpleQueue()
    assert process._handle(guard, inbox) is False
    for taken in (BEAT, process._Parent.GONE, Acknowledge()):
        inbox.put(taken)
    assert process._handle(guard, inbox) is True
    assert guard.told == [BEAT, Acknowledge()]


@pytest.mark.hazard("H32")
def test_commands_without_end_do_not_keep_a_turn_from_its_end() -> None:
    guard, inbox = Guard(), SimpleQueue()
    inbox.put(process._Parent.GONE)
    for _ in range(1000):
        inbox.put(BEAT)
    assert process._handle(guard, inbox) is True
    assert len(guard.told) < 100  # the arm is looked at before the rest
    assert process._handle(guard, inbox) is False


@pytest.mark.hazard("H32")
def test_a_turn_waits_for_less_than_a_cycle_of_the_arm_and_only_if_nothing_has_arrived(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    waits_s: list[float] = []

    def get(timeout: float) -> Heartbeat:
        waits_s.append(timeout)
        if len(waits_s) > 2:
            raise Empty
        return BEAT

    monkeypatch.setattr(process, "time", SimpleNamespace(monotonic=lambda: 100.0))
    process._handle(Guard(), SimpleNamespace(get=get))
    assert 0.0 < waits_s[0] < CYCLE_S
    assert waits_s[1:] == [0.0, 0.0]


def test_a_guard_whose_parent_is_gone_stops_once_and_goes_on_until_the_arm_is_at_rest() -> None:
    guard, inbox, ends = Guard(turns=3), SimpleQueue(), Ends()
    inbox.put(process._Parent.GONE)
    process._turn_until_over(guard, inbox, ends, ends)
    assert guard.told == ["parent lost", "tick", "tick", "tick"]
    assert ends.pushed == 3


@pytest.mark.parametrize("cause", ["broken", "adopted"])
def test_a_parent_that_is_gone_shows_by_the_pipe_and_by_whose_child_this_is(
    monkeypatch: pytest.MonkeyPatch, cause: str
) -> None:
    """A forked process may hold the pipe still, and an orphan has another parent."""
    guard, ends = Guard(turns=2), Ends()
    ends.broken = cause == "broken"
    parents = iter([100] + [1 if cause == "adopted" else 100] * 9)
    monkeypatch.setattr(process.os, "getppid", lambda: next(parents))
    process._turn_until_over(guard, SimpleQueue(), ends, ends)
    assert guard.told == ["parent lost", "tick", "tick"]


@pytest.mark.parametrize("cause", ["severed", "stuck"])
def test_a_guard_that_cannot_go_on_ends_once_the_arm_is_at_rest(cause: str) -> None:
    guard, ends = Guard(turns=2), Ends()
    guard.severed, ends.stuck = cause == "severed", cause == "stuck"
    process._turn_until_over(guard, SimpleQueue(), ends, ends)
    assert guard.told == ["tick", "tick"]


@pytest.fixture
def own_signals() -> Iterator[None]:
    """This process as it was, whatever a guard's process does to its own, and with a terminal's interrupt heeded."""
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    signal.signal(signal.SIGINT, signal.default_int_handler)
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    yield
    os.close(signal.set_wakeup_fd(-1))
    for number, handler in handlers.items():
        signal.signal(number, handler)
    signal.pthread_sigmask(signal.SIG_SETMASK, mask)


@pytest.mark.usefixtures("own_signals")
def test_a_process_that_is_asked_to_end_stops_the_arm_first() -> None:
    guard, inbox = Guard(), SimpleQueue()
    asked = process._heed_signals()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN  # a terminal's interrupt is the service's affair
    assert signal.SIGTERM in signal.pthread_sigmask(signal.SIG_BLOCK, ())  # none interrupts the loop
    thread = threading.Thread(target=process._await_end, args=(asked, guard, inbox), daemon=True)
    thread.start()
    assert inbox.empty()
    os.kill(os.getpid(), signal.SIGTERM)
    thread.join(PATIENCE_S)
    assert guard.told == ["asked to end"]
    assert drained(inbox) == [process._Parent.GONE]
    os.close(asked)


def test_what_a_library_prints_does_not_reach_the_pipe_of_the_events(capfd: pytest.CaptureFixture[str]) -> None:
    events = process._take_stdout()
    os.write(1, b"noise")
    os.write(events, b"event")
    os.dup2(events, 1)
    os.close(events)
    assert capfd.readouterr() == ("event", "noise")


def test_a_guard_s_process_is_ready_before_its_loop_and_leaves_its_journal_whole(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    did: list[str] = []
    threads: SimpleQueue[tuple[str, bool]] = SimpleQueue()

    def noted(what: str, answer: object = None) -> Callable[..., object]:
        return lambda *_, **named: (did.append(" ".join((what, *map(str, named.values())))), answer)[1]

    def running(*_: object) -> None:
        threads.put((threading.current_thread().name, threading.current_thread().daemon))

    journal, arm = SimpleNamespace(close=noted("journal closed")), SimpleNamespace(close=noted("arm closed"))
    answers = {
        "_take_stdout": 1,
        "Outbox": Ends(),
        "Journal": journal,
        "UR5": arm,
        "Guard": Guard(),
        "_heed_signals": 0,
    }
    steps = ("take_short_turns", "take_precedence", "end_with_parent", "spare_what_is_loaded", "_turn_until_over")
    for name in (*answers, *steps):
        monkeypatch.setattr(process, name, noted(name, answers.get(name)))
    for name in ("_receive", "_await_end"):
        monkeypatch.setattr(process, name, running)
    monkeypatch.setattr(process.os, "_exit", lambda status: did.append(f"exit {status}"))
    process.run("10.0.0.1", tmp_path)
    assert sorted(threads.get(timeout=PATIENCE_S) for _ in range(2)) == [("commands", True), ("end", True)]
    assert did.index("take_precedence True") < did.index("UR5")  # which has threads of its own
    *before, loop, first, second, last = did
    assert {"take_short_turns", "_heed_signals", "end_with_parent", "spare_what_is_loaded"} <= set(before)
    assert (loop, first, second, last) == ("_turn_until_over", "journal closed", "arm closed", "exit 0")


@pytest.fixture
def spawned(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Callable[[str], GuardChild]]:
    """The parent's end of a process that says its arguments, and then goes on as it is told."""
    children: list[GuardChild] = []

    def spawn(then: str) -> GuardChild:
        program = tmp_path / "program"
        program.write_text(f'#!/bin/sh\necho "$@"\n{then}\n')
        program.chmod(0o700)
        monkeypatch.setattr(sys, "executable", str(program))
        children.append(GuardChild("10.0.0.1", tmp_path))
        assert lines_of(children[-1], 1) == [f"-m robot.guard --arm 10.0.0.1 --journal {tmp_path}".encode()]
        return children[-1]

    yield spawn
    for child in children:
        child.end(at_once=True)


@pytest.fixture
def echo(spawned: Callable[[str], GuardChild]) -> GuardChild:
    """One that says again whatever it hears."""
    return spawned("exec cat")


def lines_of(child: GuardChild, count: int) -> list[bytes]:
    lines: list[bytes] = []
    while len(lines) < count:
        part = child.read(PATIENCE_S)
        assert part, "nothing came"
        lines += part
    return lines


def test_lines_go_to_the_process_and_come_back_whole(echo: GuardChild) -> None:
    assert os.getsid(echo.pid) == echo.pid != os.getsid(0)  # a terminal's interrupt does not reach it
    assert echo.read(0.0) == []
    assert echo.send(b"one\ntw") is True
    assert echo.send(b"o\n") is True
    assert lines_of(echo, 2) == [b"one", b"two"]


@pytest.fixture
def many_descriptors() -> Iterator[None]:
    """More of them open than `select` can count."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(before[0], min(2048, before[1])), before[1]))
    taken = [os.open(os.devnull, os.O_RDONLY) for _ in range(1100)]
    yield
    for descriptor in taken:
        os.close(descriptor)
    resource.setrlimit(resource.RLIMIT_NOFILE, before)


def test_a_process_is_heard_however_many_descriptors_its_parent_has_open(many_descriptors: None, spawned) -> None:
    echo = spawned("exec cat")
    assert echo.send(b"one\n") is True
    assert lines_of(echo, 1) == [b"one"]


def test_what_a_process_prints_is_logged_line_by_line(spawned, monkeypatch: pytest.MonkeyPatch) -> None:
    logged: SimpleQueue[dict[str, object]] = SimpleQueue()
    log = SimpleNamespace(warning=lambda event, **more: logged.put({"event": event, **more}))
    monkeypatch.setattr("robot.guard.child._log", log)
    child = spawned("printf 'lost the \\n\\nconnection\\n' >&2; exec cat")
    for said in ("lost the", "connection"):
        assert logged.get(timeout=PATIENCE_S) == {"event": "guard_said", "pid": child.pid, "said": said}


@pytest.mark.hazard("H17")
def test_a_process_never_waits_for_its_prints_to_be_taken(spawned, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robot.guard.child._log_what_is_said", lambda *_: None)
    child = spawned("read go; head -c 2000000 /dev/zero >&2; echo on")  # more than a pipe holds
    assert child.send(b"go\n") is True
    assert lines_of(child, 1) == [b"on"]


def test_a_process_that_does_not_read_takes_no_more_than_fits(echo: GuardChild) -> None:
    os.kill(echo.pid, signal.SIGSTOP)
    taken = [echo.send(b"x" * 4095 + b"\n") for _ in range(400)]  # more than two pipes and a buffer hold
    assert taken[0] is True
    assert taken[-1] is False


def test_a_process_that_is_dismissed_ends_by_itself_and_hears_nothing_more(echo: GuardChild) -> None:
    echo.dismiss()
    assert echo.send(b"late\n") is False
    assert echo.read(PATIENCE_S) is None
    echo.end(at_once=False)
    assert echo._process.returncode == 0


def test_a_process_that_does_not_end_is_killed(echo: GuardChild, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robot.guard.child._END_S", 0.01)
    os.kill(echo.pid, signal.SIGSTOP)
    echo.dismiss()
    echo.end(at_once=False)
    assert echo._process.returncode == -signal.SIGKILL


def test_a_process_that_ends_by_itself_in_time_is_not_killed(spawned: Callable[[str], GuardChild]) -> None:
    child = spawned("cat\nsleep 0.05")
    child.dismiss()
    child.end(at_once=False)
    assert child._process.returncode == 0


def test_a_process_that_is_to_end_at_once_is_not_waited_for_and_takes_no_line(
    echo: GuardChild, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robot.guard.child._END_S", 1000.0)
    echo.end(at_once=True)
    assert echo._process.returncode == -signal.SIGKILL
    assert echo.send(b"late\n") is False
