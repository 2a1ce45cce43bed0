"""The stream of a case's events, for server-sent events: every event once, in order, from any point on."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import suppress

from service.cases import store
from service.cases.records import StoredEvent
from service.database.engines import Database

# Another process of the fleet may append too, and only this one's commits wake the stream.
_POLL_S = 1.0


class EventFeed:
    """Streams of events, woken by each commit of this process."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._sleepers: set[tuple[asyncio.AbstractEventLoop, asyncio.Event]] = set()
        database.on_commit.append(self._wake)

    async def follow(self, case_id: str, after: int = 0) -> AsyncIterator[StoredEvent]:
        """The events behind sequence `after` (Last-Event-ID), then every new one, until the caller stops."""
        sleeper = (asyncio.get_running_loop(), asyncio.Event())
        self._sleepers.add(sleeper)
        try:
            while True:
                sleeper[1].clear()
                for event in await asyncio.to_thread(self._after, case_id, after):
                    yield event
                    after = event.sequence
                await self._sleep(sleeper[1])
        finally:
            self._sleepers.discard(sleeper)

    async def _sleep(self, event: asyncio.Event) -> None:
        # not wait_for, which in Python 3.11 takes a cancellation for nothing where the event comes with it
        with suppress(TimeoutError):
            async with asyncio.timeout(_POLL_S):
                await event.wait()

    def _after(self, case_id: str, sequence: int) -> list[StoredEvent]:
        with self._database.read() as connection:
            return store.events_after(connection, case_id, sequence)

    def _wake(self) -> None:
        for loop, event in tuple(self._sleepers):
            if not loop.is_closed():
                loop.call_soon_threadsafe(event.set)
