"""The service's end of the guard over a process of words, with a clock that the words turn."""

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace

import pytest
import structlog
from structlog.testing import capture_logs

from robot.errors import GuardDownError
from robot.guard import child as process
from robot.guard import client as module
from robot.guard import course
from robot.guard.client import GuardClient, GuardConfig
from robot.guard.journal import FLUSH_S
from robot.guard.lines import decode_command, encode
from robot.guard.messages import (
    Acknowledge,
    BeginMove,
    Event,
    Fault,
    FaultKind,
    Heartbeat,
    Phase,
    ReleasePendant,
    Status,
    Stop,
)
from tests.waiting import until

PATIENCE_S = 20.0
RESTART_AFTER_S = 0.02
ENGINE_S = 10.0  # what an engine of containers gives a service that it asked to end, before it kills it


def status(sequence: int, phase: Phase = Phase.IDLE, connected: bool = True) -> bytes:
    return encode(Status(sequence, 90.0, phase, "challenge", connected, None, None, False, None)).rstrip()


@dataclass
class Child:
    """A guard process that says what it is given; each word comes after a time. At its end it waits to be dismissed."""

    words: list[tuple[float, list[bytes] | None]]
    clock: SimpleNamespace
    pid: int = 7
    takes_commands: bool = True
    sent: list[bytes] = field(default_factory=list)
    ended_at_once: bool | None = None
    silent: threading.Event = field(default_factory=threading.Event)  # has said all
    dismissed: threading.Event = field(default_factory=threading.Event)

    def read(self, timeout_s: float) -> list[bytes] | None:
        assert timeout_s > 0.0
        if not self.words:
            self.silent.set()
            assert self.dismissed.wait(PATIENCE_S)
            return None
        after_s, lines = self.words.pop(0)
        self.clock.now_s += after_s
        return lines

    def send(self, line: bytes) -> bool:
        self.sent.append(line)
        return self.takes_commands

    def dismiss(self) -> None:
        self.dismissed.set()

    def end(self, at_once: bool) -> None:
        self.ended_at_once = at_once


@dataclass
class World:
    """What the client meets: guard processes one after the other, and a dashboard."""

    clock: SimpleNamespace
    children: list[Child | OSError] = field(default_factory=list)
    spawned: list[tuple[str, Path]] = field(default_factory=list)
    spawned_at_s: list[float] = field(default_factory=list)  # of the room's clock, which nobody turns
    stops: list[str] = field(default_factory=list)
    stopped_by: list[threading.Thread] = field(default_factory=list)
    precedence: list[bool] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    fails_to_listen: bool = False
    while_spawning: Callable[[], object] = lambda: None

    def child(self, *words: tuple[float, list[bytes] | None]) -> Child:
        """The next process that will be started."""
        self.children.append(Child(list(words), self.clock))
        return self.children[-1]

    def spawn(self, address: str, folder: Path) -> Child:
        self.spawned.append((address, folder))
        self.spawned_at_s.append(time.monotonic())
        self.while_spawning()
        child = self.children[len(self.spawned) - 1]
        if isinstance(child, OSError):
            raise child
        return child

    def stop(self, address: str) -> None:
        self.stopped_by.append(threading.current_thread())
        self.stops.append(address)

    def hear(self, event: Event) -> None:
        self.events.append(event)
        if self.fails_to_listen:
            raise RuntimeError("the listener's own fault")


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    world = World(SimpleNamespace(now_s=100.0))
    monkeypatch.setattr(module, "GuardChild", world.spawn)
    monkeypatch.setattr(module, "stop_by_dashboard", world.stop)
    monkeypatch.setattr(module, "take_precedence", lambda *, passed_on: world.precedence.append(passed_on))
    monkeypatch.setattr(module, "_log", structlog.get_logger())  # one that is bound to no earlier configuration
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: world.clock.now_s))
    return world


@pytest.fixture
def client(world: World, tmp_path: Path) -> Iterator[GuardClient]:
    client = GuardClient(GuardConfig("10.0.0.1", tmp_path, restart_after_s=RESTART_AFTER_S), world.hear)
    yield client
    client.close()
    assert not any(thread.name == "guard" for thread in threading.enumerate())


def test_events_are_passed_on_and_the_newest_status_is_kept(world: World, client: GuardClient, tmp_path: Path) -> None:
    child = world.child((0.1, [status(1), status(2)]), (0.1, []), (0.2, [status(3)]))
    assert (client.status, client.status_age_s, client.process_id) == (None, None, None)
    client.start()
    assert child.silent.wait(PATIENCE_S)
    assert [event.sequence for event in world.events] == [1, 2, 3]
    assert client.status.sequence == 3
    assert client.status_age_s == pytest.approx(100.4 - 90.0)
    assert client.process_id == 7
    assert world.spawned == [("10.0.0.1", tmp_path)]
    assert world.precedence == [False]
    client.close()
    assert child.ended_at_once is False  # asked to, and nothing is mourned
    assert (world.stops, client.process_id) == ([], None)
    assert not any(isinstance(event, Fault) for event in world.events)


def test_what_else_a_guard_says_is_passed_on_and_leaves_its_status(world: World, client: GuardClient) -> None:
    fault = encode(Fault(FaultKind.ARM_OFF, 90.0, "off")).rstrip()
    child = world.child((0.1, [status(1), fault]), (0.9, [fault]))
    client.start()
    assert child.silent.wait(PATIENCE_S)
    assert [type(event) for event in world.events] == [Status, Fault, Fault]
    assert client.status.sequence == 1


def test_commands_reach_the_process_as_lines(world: World, client: GuardClient, move: BeginMove) -> None:
    child = world.child()
    client.start()
    assert child.silent.wait(PATIENCE_S)
    client.begin_move(move)
    client.heartbeat(Heartbeat("p", 1, "c", True))
    assert client.acknowledge() is True
    assert [type(decode_command(line)) for line in child.sent] == [BeginMove, Heartbeat, Acknowledge]


def test_a_stop_goes_by_the_guard_and_by_the_dashboard_too(world: World, client: GuardClient) -> None:
    child = world.child()
    client.start()
    assert child.silent.wait(PATIENCE_S)
    assert client.stop("asked") is True
    assert client.release_pendant("access") is True
    assert [decode_command(line) for line in child.sent] == [Stop("asked"), ReleasePendant("access")]
    until(lambda: world.stops == ["10.0.0.1"] * 2)


@pytest.mark.hazard("H32")
def test_on_a_machine_without_a_thread_left_a_stop_goes_both_ways_all_the_same(
    world: World, client: GuardClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    child = world.child()
    client.start()
    assert child.silent.wait(PATIENCE_S)

    def no_thread_left(_thread: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", no_thread_left)
    assert client.stop("asked") is True
    assert [decode_command(line) for line in child.sent] == [Stop("asked")]
    assert world.stops == ["10.0.0.1"]


def test_without_a_guard_nothing_begins_and_a_stop_goes_by_the_dashboard_alone(
    world: World, client: GuardClient, move: BeginMove
) -> None:
    with pytest.raises(GuardDownError):
        client.begin_move(move)
    client.heartbeat(Heartbeat("p", 1, "c", True))
    assert (client.stop("asked"), client.acknowledge()) == (False, False)
    until(lambda: world.stops == ["10.0.0.1"])


def test_a_full_pipe_takes_no_motion(world: World, client: GuardClient, move: BeginMove) -> None:
    child = world.child()
    child.takes_commands = False
    client.start()
    assert child.silent.wait(PATIENCE_S)
    with pytest.raises(GuardDownError):
        client.begin_move(move)
    assert client.acknowledge() is False


@pytest.mark.hazard("H17")
def test_the_death_of_a_guard_stops_the_arm_and_is_told_before_the_next_one_speaks(
    world: World, client: GuardClient
) -> None:
    dead, next_one = world.child((0.1, [status(1)]), (0.1, None)), world.child((0.1, [status(2)]))
    client.start()
    assert next_one.silent.wait(PATIENCE_S)
    assert [type(event) for event in world.events] == [Status, Fault, Status]
    fault = world.events[1]
    assert (fault.kind, fault.at_s) == (FaultKind.GUARD_LOST, pytest.approx(100.2))
    assert world.stops == ["10.0.0.1"]
    assert dead.ended_at_once is True
    assert client.status.sequence == 2


def test_between_two_guards_there_is_no_status(world: World, client: GuardClient) -> None:
    world.child((0.1, [status(1)]), (0.1, None))
    next_one = world.child()
    client.start()
    assert next_one.silent.wait(PATIENCE_S)
    assert (client.status, client.status_age_s) == (None, None)


STARTING, AWAY = status(1, Phase.STARTING), status(1, connected=False)


@pytest.mark.parametrize(
    ("first", "silence_s", "killed"),
    [
        ([], 8.0, False),  # it starts
        ([], 8.001, True),
        ([status(1)], 1.0, False),
        ([status(1)], 1.001, True),
        ([STARTING], 8.0, False),  # it takes control, which blocks
        ([STARTING], 8.001, True),
        ([AWAY], 8.0, False),  # it looks for a controller
        ([AWAY], 8.001, True),
        ([STARTING, status(2)], 1.001, True),
    ],
)
def test_a_guard_that_falls_silent_is_killed(
    world: World, client: GuardClient, first: list[bytes], silence_s: float, killed: bool
) -> None:
    world.clock.now_s = 0.0  # so that the silences are exact
    child = world.child((0.0, first), (silence_s, []))
    next_one = world.child()
    client.start()
    assert (next_one if killed else child).silent.wait(PATIENCE_S)
    assert child.ended_at_once is (True if killed else None)


def test_every_status_ends_a_silence(world: World, client: GuardClient) -> None:
    child = world.child(*((0.9, [status(number)]) for number in range(5)))
    client.start()
    assert child.silent.wait(PATIENCE_S)
    assert child.ended_at_once is None


def test_a_guard_that_says_what_is_no_message_is_killed(world: World, client: GuardClient) -> None:
    child, next_one = world.child((0.1, [status(1), b"{}", status(2)])), world.child()
    client.start()
    assert next_one.silent.wait(PATIENCE_S)
    assert child.ended_at_once is True
    assert [type(event) for event in world.events] == [Status, Fault]


def test_a_machine_without_a_process_left_is_asked_again_and_the_log_says_why(
    world: World, client: GuardClient
) -> None:
    world.children.append(OSError("no process left"))
    child = world.child((0.0, [status(1)]))
    with capture_logs() as log:
        client.start()
        assert child.silent.wait(PATIENCE_S)
    assert len(world.spawned) == 2
    assert [type(event) for event in world.events] == [Status]
    assert ["no process left" in entry["error"] for entry in log] == [True]


def test_a_guard_that_cannot_live_is_not_started_again_and_again_without_a_pause(
    world: World, client: GuardClient
) -> None:
    world.child((0.0, None))
    world.children.append(OSError("no process left"))
    child = world.child()
    client.start()
    assert child.silent.wait(PATIENCE_S)
    died_s, refused_s, started_s = world.spawned_at_s
    assert min(refused_s - died_s, started_s - refused_s) >= RESTART_AFTER_S


def test_a_service_that_fails_without_closing_is_not_kept_alive_by_its_guard(world: World, client: GuardClient) -> None:
    """Its end is what the guard stops the arm for."""
    child = world.child()
    client.start()
    assert child.silent.wait(PATIENCE_S)
    client.stop("asked")
    until(lambda: world.stopped_by != [])
    supervising = [thread for thread in threading.enumerate() if thread.name == "guard"]
    assert [thread.daemon for thread in (*supervising, *world.stopped_by)] == [True, True]


def test_a_guard_gets_the_time_to_bring_its_arm_to_rest(tmp_path: Path) -> None:
    """Before it is killed; and whoever closes the client awaits that, and is done before the engine loses patience."""
    assert process._END_S > course._GIVE_UP_S + FLUSH_S
    assert process._END_S + module._LOOK_S < module._CLOSE_S < ENGINE_S


def test_a_listener_that_fails_does_not_end_the_supervision_and_is_logged(world: World, client: GuardClient) -> None:
    world.fails_to_listen = True
    child = world.child((0.1, [status(1)]), (0.1, [status(2)]))
    with capture_logs() as log:
        client.start()
        assert child.silent.wait(PATIENCE_S)
    assert [(entry["event_type"], "own fault" in entry["error"]) for entry in log] == [("Status", True)] * 2
    assert client.status.sequence == 2
    assert child.ended_at_once is None


def test_a_guard_that_starts_while_the_client_closes_is_dismissed(world: World, client: GuardClient) -> None:
    """Whoever closes sees no process yet, and the one that comes must not stay."""
    child, closing = world.child(), threading.Thread(target=client.close)
    world.while_spawning = lambda: (closing.start(), until(client._closing.is_set))
    client.start()
    assert child.dismissed.wait(PATIENCE_S)
    closing.join(PATIENCE_S)
    assert child.ended_at_once is False
