"""A PostgreSQL server that takes what is sent and answers nothing; a service that is gone with the turn to write."""

import socket
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress

import pytest
import sqlalchemy as sa

from service.database import postgresql as connections
from service.database.engines import Database, open_database
from service.errors import ErrorCode, ServiceError

_PATIENCE_S = 0.3
_SOON_S = 10.0  # far below what either side would wait by itself


class Relay:
    """Passes on what a server and its clients say, until it is frozen; nobody's connection ends."""

    def __init__(self, server: sa.URL) -> None:
        self._server = (server.host, server.port)
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = self._listening.getsockname()[1]
        self.flows = threading.Event()
        self.flows.set()
        self._ends: list[socket.socket] = [self._listening]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        while True:
            try:
                client = self._listening.accept()[0]
            except OSError:  # closed
                return
            server = socket.create_connection(self._server)
            self._ends += [client, server]
            for one, other in ((client, server), (server, client)):
                threading.Thread(target=self._pass_on, args=(one, other), daemon=True).start()

    def _pass_on(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):  # either end is closed
            while said := one.recv(65536):
                self.flows.wait()
                other.sendall(said)
        _shut(other)

    def close(self) -> None:
        self.flows.set()
        for end in self._ends:
            _shut(end)
            end.close()


def _shut(end: socket.socket) -> None:
    """Whoever waits at it is told."""
    with suppress(OSError):
        end.shutdown(socket.SHUT_RDWR)


@pytest.fixture
def address(postgresql, tmp_path):
    with postgresql.migrated(tmp_path) as address:
        yield sa.make_url(address)


@pytest.fixture
def relay(address):
    relay = Relay(address)
    yield relay
    relay.close()


@pytest.fixture
def opened():
    """Opens databases that are closed at the end."""
    with ExitStack() as stack:

        def open_it(address: sa.URL) -> Database:
            database = open_database(address.render_as_string(hide_password=False))
            stack.callback(database.close)
            return database

        yield open_it


def _refusal(within: Database, *, writes: bool) -> ServiceError:
    began_s = time.monotonic()
    with pytest.raises(ServiceError) as refused:
        _ask(within, writes=writes)
    assert time.monotonic() - began_s < _SOON_S
    return refused.value


def _ask(database: Database, *, writes: bool) -> int | None:
    with database.write() if writes else database.read() as connection:
        return connection.execute(sa.text("SELECT 7")).scalar()


@pytest.mark.hazard("H24")
@pytest.mark.parametrize("writes", [False, True])
def test_a_server_that_answers_nothing_is_a_typed_fault_and_is_asked_anew(address, relay, opened, writes) -> None:
    database = opened(address.set(host="127.0.0.1", port=relay.port))
    database.expect_answers(_PATIENCE_S)
    assert _ask(database, writes=writes) == 7
    relay.flows.clear()
    refused = _refusal(database, writes=writes)
    assert (refused.code, f"within {_PATIENCE_S} s" in str(refused)) == (ErrorCode.DATABASE_FAULT, True)
    relay.flows.set()
    assert _ask(database, writes=writes) == 7


def test_a_turn_that_another_room_keeps_is_not_waited_for_without_an_end(address, opened, monkeypatch) -> None:
    monkeypatch.setattr(connections, "BUSY_S", _PATIENCE_S)
    one, other = opened(address), opened(address)
    with one.write():
        assert _refusal(other, writes=True).code == ErrorCode.DATABASE_BUSY
    assert _ask(other, writes=True) == 7


@pytest.mark.hazard("H24")
def test_a_service_that_is_gone_amid_a_write_gives_the_turn_back(address, relay, opened, monkeypatch) -> None:
    monkeypatch.setattr(connections, "_ABANDONED_S", _PATIENCE_S)
    gone, other = opened(address.set(host="127.0.0.1", port=relay.port)), opened(address)
    with pytest.raises(ServiceError) as refused:
        _write_beside(gone, lambda: _asks_while_frozen(other, relay))
    assert refused.value.code == ErrorCode.DATABASE_FAULT
    assert _ask(gone, writes=True) == 7


def _write_beside(database: Database, meanwhile: Callable[[], None]) -> None:
    with database.write() as connection:
        connection.execute(sa.text("SELECT 1"))
        meanwhile()
        connection.execute(sa.text("SELECT 1"))


def _asks_while_frozen(other: Database, relay: Relay) -> None:
    relay.flows.clear()
    assert _ask(other, writes=True) == 7
    relay.flows.set()
