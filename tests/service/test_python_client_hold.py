"""The held button of the public client against a guard that only listens: however its context is left, it lets go."""

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http import HTTPStatus
from itertools import count
from queue import Queue
from threading import Thread

import pytest
from websockets.asyncio.client import ClientConnection
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import Server, ServerConnection, serve

from coaxial_client import Coaxial, Hold, HoldEnded, NoAnswer
from tests.certificates import Certificate

_ENDED = {"type": "ended", "cause": "released", "state": "moved", "version": 7}
_ENDED |= {"distance_mm": 1.0, "angle_deg": 0.0, "problem": None}
# Of presses whose connection two threads used, some of a hundred got no answer on a busy machine.
_PRESSES = 300


@dataclass
class Guard:
    """Challenges whoever holds, hears the heartbeats, and says that the motion is over once the button is let go."""

    breaks_after: int | None = None  # heartbeats
    beats: "Queue[dict]" = field(default_factory=Queue)
    url: str = ""

    def listen(self, connection: ServerConnection) -> None:
        for number in count():
            connection.send(json.dumps({"type": "progress", "challenge": f"c{number}"}))
            try:
                beat = json.loads(connection.recv())
            except ConnectionClosed:
                return
            self.beats.put(beat)
            if not beat["held"]:
                connection.send(json.dumps(_ENDED))
                return
            if number == self.breaks_after:
                connection.socket.close()
                return


@dataclass
class Hasty(Guard):
    """Says that the motion is over, and closes, right behind a challenge."""

    def listen(self, connection: ServerConnection) -> None:
        connection.send(json.dumps({"type": "progress", "challenge": "first"}))
        self.beats.put(json.loads(connection.recv()))
        connection.send(json.dumps({"type": "progress", "challenge": "last"}))
        connection.send(json.dumps(_ENDED))


@contextmanager
def _up(guard: Guard, certificate: Certificate | None = None) -> Iterator[Guard]:
    tls = None if certificate is None else certificate.server_context()
    with serve(guard.listen, "localhost", 0, ssl=tls, process_request=_status) as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        guard.url = f"{'http' if tls is None else 'https'}://localhost:{_port(server)}"
        try:
            yield guard
        finally:
            server.shutdown()
            thread.join()


def _port(server: Server) -> int:
    return int(server.socket.getsockname()[1])


def _status(connection: ServerConnection, request: Request) -> Response | None:
    """What is no WebSocket is answered as the room's status."""
    return None if "hold" in request.path else connection.respond(HTTPStatus.OK, '{"open_case": null}')


@pytest.fixture
def guard() -> Iterator[Guard]:
    with _up(Guard()) as guard:
        yield guard


def _hold(guard: Guard, longest_s: float = 60.0) -> Hold:
    return Coaxial(guard.url).case("c").hold("permit", longest_s)


def _heard(guard: Guard) -> list[dict]:
    return [guard.beats.get_nowait() for _ in range(guard.beats.qsize())]


def _raise(error: type[BaseException]) -> None:
    raise error


@pytest.mark.parametrize("leave", [lambda: None, lambda: _raise(ValueError), lambda: _raise(KeyboardInterrupt)])
def test_however_the_context_is_left_the_button_is_let_go_once(guard, leave: Callable[[], None]) -> None:
    try:
        with _hold(guard):
            assert guard.beats.get(timeout=10)["held"]
            leave()
    except (ValueError, KeyboardInterrupt):
        pass
    assert [beat["held"] for beat in _heard(guard)][-1:] == [False]


def test_a_program_that_is_stuck_lets_go_after_the_longest_time(guard) -> None:
    with _hold(guard, longest_s=0.2) as hold:
        ended = hold.wait(10.0)
    assert ended == HoldEnded("released", "moved", 7, 1.0, 0.0, None)
    assert not _heard(guard)[-1]["held"]


def test_every_heartbeat_has_a_new_number_and_the_newest_challenge(guard) -> None:
    with _hold(guard) as hold:
        beats = [guard.beats.get(timeout=10) for _ in range(5)]
        hold.release()
    assert [beat["number"] for beat in beats] == [1, 2, 3, 4, 5]
    assert [beat["challenge"] for beat in beats] == [f"c{number}" for number in range(5)]


def test_a_connection_that_breaks_is_no_answer_and_ends_the_hold() -> None:
    with _up(Guard(breaks_after=1)) as guard, _hold(guard) as hold, pytest.raises(NoAnswer, match="silence stops"):
        hold.wait(10.0)


def test_an_ending_counts_though_the_connection_is_closed_before_it_is_read(monkeypatch) -> None:
    closed = threading.Event()
    send = ClientConnection.send

    async def send_late(connection: ClientConnection, text: str) -> None:
        if "last" in text:
            await connection.wait_closed()  # all has come, the closing too
            closed.set()
        await send(connection, text)

    monkeypatch.setattr(ClientConnection, "send", send_late)
    with _up(Hasty()) as guard, _hold(guard) as hold:
        assert hold.wait(20.0).cause == "released"
    assert closed.is_set()


def test_an_authority_of_the_hospitals_own_is_trusted_if_it_is_named(certificate) -> None:
    with _up(Guard(), certificate) as guard:
        with Coaxial(guard.url, ca_file=certificate.file) as client:
            assert client.status() == {"open_case": None}
            with client.case("c").hold("permit") as hold:
                assert guard.beats.get(timeout=10)["held"]
                hold.release()
                assert hold.wait(10.0).cause == "released"
        with Coaxial(guard.url) as client, pytest.raises(NoAnswer, match="CERTIFICATE_VERIFY_FAILED"):
            client.status()
        with Coaxial(guard.url) as client, pytest.raises(NoAnswer), client.case("c").hold("permit"):
            pass


def test_a_button_that_was_let_go_before_it_is_pressed_says_nothing(guard) -> None:
    hold = _hold(guard)
    hold.release()
    with hold, pytest.raises(TimeoutError):
        hold.wait(0.2)
    hold.release()
    assert not any(beat["held"] for beat in _heard(guard))


def test_every_press_through_tls_is_heard(certificate) -> None:
    with _up(Guard(), certificate) as guard, Coaxial(guard.url, ca_file=certificate.file) as client:
        for _ in range(_PRESSES):
            with client.case("c").hold("permit"):
                assert guard.beats.get(timeout=10)["held"]
            assert not _heard(guard)[-1]["held"]


def test_an_authority_without_tls_is_a_mistake(certificate) -> None:
    with pytest.raises(ValueError, match="begins with https"):
        Coaxial("http://localhost", ca_file=certificate.file)
