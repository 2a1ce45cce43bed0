"""Connections that get nowhere: ended in time, and in nobody's way."""

import asyncio
import resource
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from urllib.parse import urlsplit

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocket
from websockets.asyncio.client import connect

from service import connections
from service.auth.permissions import Role
from service.connections import MOST_WAITED_FOR, PromptProtocol, allow_descriptors
from tests.waiting import until

_HEAD = b"GET /api/health/live HTTP/1.1\r\nHost: room\r\n"
_BODY = b"POST /api/session HTTP/1.1\r\nHost: room\r\nContent-Type: application/json\r\nContent-Length: 100\r\n\r\n{"
_PATIENCE_S = 30.0


@pytest.fixture
def descriptors():
    """Enough for both ends of a flood, which are in one process here."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    allow_descriptors()
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, before)


@contextmanager
def _connected(running, source: str = "127.0.0.1") -> Iterator[socket.socket]:
    address = urlsplit(running.url)
    with socket.create_connection((address.hostname, address.port), _PATIENCE_S, (source, 0)) as connection:
        yield connection


def _is_ended(connection: socket.socket) -> bool:
    try:
        return connection.recv(1) == b""
    except ConnectionResetError:
        return True


def _trickle(connection: socket.socket, byte: bytes) -> bool:
    """Whether the connection is ended while bytes go on coming."""
    end_s = time.monotonic() + _PATIENCE_S
    connection.settimeout(0.05)
    while time.monotonic() < end_s:
        try:
            connection.sendall(byte)
            if connection.recv(4096) == b"":  # else the rest of an answer
                return True
        except TimeoutError:
            continue
        except OSError:
            return True
    return False


@pytest.mark.parametrize("begun", [b"", _HEAD], ids=["silent", "half a head"])
def test_a_head_that_does_not_come_whole_ends_its_connection(running, monkeypatch, begun):
    monkeypatch.setattr(connections, "_HEAD_S", 0.2)
    with _connected(running) as connection:
        connection.sendall(begun)
        assert _is_ended(connection)


def test_bytes_one_by_one_buy_no_time(running, monkeypatch):
    monkeypatch.setattr(connections, "_HEAD_S", 0.3)
    with _connected(running) as connection:
        connection.sendall(_HEAD + b"X-Slow: ")
        assert _trickle(connection, b"x")


def test_nor_do_they_in_a_body_or_behind_a_request_that_was_answered(running, monkeypatch):
    monkeypatch.setattr(connections, "_BODY_S", 0.3)
    with _connected(running) as connection:
        connection.sendall(_BODY)
        assert _trickle(connection, b" ")
    monkeypatch.setattr(connections, "_HEAD_S", 0.3)
    with _connected(running) as connection:
        connection.sendall(_HEAD + b"\r\n")
        assert connection.recv(4096).startswith(b"HTTP/1.1 200")
        connection.sendall(_HEAD + b"X-Slow: ")
        assert _trickle(connection, b"x")


def test_a_held_button_owes_no_body_however_long_it_is_held(monkeypatch):
    monkeypatch.setattr(connections, "_BODY_S", 0.2)
    assert asyncio.run(_said_late(0.6)) == "held"


async def _said_late(after_s: float) -> str | bytes:
    """What an open WebSocket hears of a word that it sends after a silence."""
    config = uvicorn.Config(_echo, host="127.0.0.1", port=0, http=PromptProtocol, lifespan="off", log_config=None)
    server = uvicorn.Server(config)
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(server.serve())
        await asyncio.to_thread(until, lambda: server.started)
        try:
            port = server.servers[0].sockets[0].getsockname()[1]
            async with connect(f"ws://127.0.0.1:{port}", proxy=None) as button:
                await asyncio.sleep(after_s)
                await button.send("held")
                return await button.recv()
        finally:
            server.should_exit = True


async def _echo(scope: Scope, receive: Receive, send: Send) -> None:
    button = WebSocket(scope, receive, send)
    await button.accept()
    await button.send_text(await button.receive_text())
    await button.close()


def test_a_stop_finds_room_among_1100_half_open_connections(running, descriptors, monkeypatch):
    monkeypatch.setattr(connections, "_HEAD_S", 600.0)  # so that time ends none of them
    with ExitStack() as stack:
        slow = stack.enter_context(_connected(running, "127.0.0.2"))
        slow.sendall(_HEAD)
        flood = [_half_open(stack, running) for _ in range(1100)]
        with running.client(Role.OPERATOR) as operator:
            assert operator.post("/stop").status_code == 200
        assert sum(map(_was_ended, flood)) >= len(flood) - MOST_WAITED_FOR
        slow.sendall(b"\r\n")  # older than all of them, but of a peer that has but one
        assert slow.recv(4096).startswith(b"HTTP/1.1 200")


def _half_open(stack: ExitStack, running) -> socket.socket:
    connection = stack.enter_context(_connected(running))
    connection.sendall(_HEAD)
    return connection


def _was_ended(connection: socket.socket) -> bool:
    connection.setblocking(False)
    try:
        return _is_ended(connection)
    except BlockingIOError:
        return False
