"""The stream of a case's events, for server-sent events: every event once, in order, from any point on."""

import asyncio
from collections.abc import AsyncGenerator, Iterator, Sequence
from contextlib import contextmanager
from functools import partial

from service.cases import store
from service.cases.channel import Channel, comes
from service.cases.server_sent import ServerSent, server_sent
from service.database.engines import Database

# Read at a time by one who catches up: what a slow follower keeps in memory at most.
_CAUGHT_UP = 100


class EventFeed:
    """Streams of events, woken by each commit of this process; each new event is read once for all of them."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._channels: dict[str, Channel] = {}
        database.on_commit.append(self._wake)

    async def follow(
        self, case_id: str, after: int = 0, quiet_s: float = 60.0
    ) -> AsyncGenerator[Sequence[ServerSent], None]:
        """The events behind sequence `after` (Last-Event-ID), then every new one, until the caller stops.

        An empty sequence says that none came for `quiet_s`. Who takes them slowly holds up nobody else.
        """
        with self._joined(case_id) as channel:
            while True:
                news, events = channel.news, channel.behind(after)
                if events is None:
                    events = tuple(await asyncio.to_thread(self._read, case_id, after))
                if events:
                    after = events[-1].sequence
                    yield events
                elif not await comes(news, quiet_s):
                    yield ()

    @contextmanager
    def _joined(self, case_id: str) -> Iterator[Channel]:
        """The case's channel, which is there as long as anybody follows the case."""
        channel = self._channels.get(case_id)
        if channel is None:
            channel = Channel(partial(self._newest, case_id), partial(self._read, case_id))
            self._channels[case_id] = channel
        channel.followers += 1
        try:
            yield channel
        finally:
            channel.followers -= 1
            if channel.followers == 0:
                channel.close()
                del self._channels[case_id]

    def _newest(self, case_id: str) -> int:
        with self._database.read() as connection:
            return store.newest_sequence(connection, case_id)

    def _read(self, case_id: str, sequence: int) -> list[ServerSent]:
        with self._database.read() as connection:
            return [server_sent(event) for event in store.events_after(connection, case_id, sequence, _CAUGHT_UP)]

    def _wake(self) -> None:
        for channel in tuple(self._channels.values()):
            channel.wake()
