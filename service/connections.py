"""HTTP connections that get nowhere: ended in time, and never so many that a stop finds no room (H31).

uvicorn bounds how long a connection may idle between two requests, not how long the first one may take to come; and
its own bound on connections refuses whoever comes last, which may be the stop.
"""

import asyncio
import resource
import socket
from collections import Counter
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

# A head is some hundred bytes, which a tablet sends at once.
_HEAD_S = 10.0
# The largest image within it needs 5 Mbit/s.
_BODY_S = 60.0
# Of these, each answered in milliseconds once it has come whole; a room with fifty screens has a few at a time.
MOST_WAITED_FOR = 256
# Accepted at once; with those that are waited for it stays below the 1024 descriptors that are usual.
BACKLOG = 256
# A peer that acknowledges nothing, or takes nothing, for so long is gone: an observer's cable was pulled.
_GONE_MS = 20_000
_DESCRIPTORS = 65_536


def allow_descriptors() -> None:
    """Let this process open as many files and connections as its hard limit allows, up to more than it ever needs."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = _DESCRIPTORS if hard == resource.RLIM_INFINITY else min(hard, _DESCRIPTORS)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


class PromptProtocol(H11Protocol):
    """A connection that must bring each request whole in time.

    Where too many are waited for, the peer with most of them loses its oldest.
    """

    def __init__(self, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        self._within_s: float | None = None  # what is waited for must come within it; None: nothing is
        self._since_s = 0.0
        self._deadline: asyncio.TimerHandle | None = None
        self._is_upgraded = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as in H11Protocol
        """Somebody connected and owes a head."""
        super().connection_made(transport)
        connected: socket.socket | None = transport.get_extra_info("socket")
        if connected is not None and connected.family in (socket.AF_INET, socket.AF_INET6):
            connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, _GONE_MS)
        self._look()

    def data_received(self, data: bytes) -> None:
        """More of a request, or all of it."""
        super().data_received(data)
        self._look()

    def on_response_complete(self) -> None:
        """The next request is owed."""
        super().on_response_complete()
        self._look()

    def connection_lost(self, exc: Exception | None) -> None:
        """Nothing is owed any more."""
        self._wait_for(None)
        super().connection_lost(exc)

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Another protocol goes on from here, though this one's reader still sees the end of a request to come."""
        self._is_upgraded = True
        super().handle_websocket_upgrade(event)

    def _look(self) -> None:
        limits_s = {h11.IDLE: _HEAD_S, h11.SEND_BODY: _BODY_S}  # by what the peer is at
        is_over = self._is_upgraded or self.transport.is_closing()
        self._wait_for(None if is_over else limits_s.get(self.conn.their_state))
        if self._within_s is not None and len(self.connections) > MOST_WAITED_FOR:
            self._make_room()

    def _wait_for(self, within_s: float | None) -> None:
        if within_s == self._within_s:
            return
        if self._deadline is not None:
            self._deadline.cancel()
        self._within_s, self._since_s = within_s, self.loop.time()
        self._deadline = None if within_s is None else self.loop.call_later(within_s, self._give_up)

    def _give_up(self) -> None:
        self._wait_for(None)
        self.transport.abort()

    def _make_room(self) -> None:
        waiting = [one for one in self.connections if isinstance(one, PromptProtocol) and one._within_s is not None]
        if len(waiting) > MOST_WAITED_FOR:
            (peer, _), *_others = Counter(one._peer for one in waiting).most_common(1)
            min((one for one in waiting if one._peer == peer), key=lambda one: one._since_s)._give_up()

    @property
    def _peer(self) -> str:
        return self.client[0] if self.client else ""
