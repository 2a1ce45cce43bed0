"""The newest events of one case, read once for everybody who follows it."""

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress

import structlog

from service.cases.server_sent import ServerSent
from service.errors import ServiceError

_log = structlog.get_logger(__name__)
# Another process of the fleet may append too, and only this one's commits wake the channel.
_POLL_S = 1.0
# Events at hand for followers that are a little behind; who is further behind reads the database.
_KEPT = 100


async def comes(event: asyncio.Event, within_s: float) -> bool:
    """Whether an event comes in time."""
    # not wait_for, which in Python 3.11 takes a cancellation for nothing where the event comes with it
    with suppress(TimeoutError):
        async with asyncio.timeout(within_s):
            return await event.wait()
    return False


class Channel:
    """Reads on behind the newest event of a case until it is closed; to be made and used on one event loop."""

    def __init__(self, newest: Callable[[], int], read: Callable[[int], list[ServerSent]]) -> None:
        self.followers = 0
        self.news = asyncio.Event()  # a new one each time that it comes
        self._loop = asyncio.get_running_loop()
        self._read_newest = newest
        self._read = read
        self._woken = asyncio.Event()
        self._newest: int | None = None
        self._tail: deque[ServerSent] = deque(maxlen=_KEPT)
        self._reading = asyncio.create_task(self._read_on())

    def behind(self, sequence: int) -> tuple[ServerSent, ...] | None:
        """The events behind `sequence`; None where they are not all at hand."""
        if self._newest is None:
            return None
        if sequence >= self._newest:
            return ()
        if not self._tail or self._tail[0].sequence > sequence + 1:
            return None
        return tuple(event for event in self._tail if event.sequence > sequence)

    def wake(self) -> None:
        """There may be new events; from any thread."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._woken.set)

    def close(self) -> None:
        """Read no more."""
        self._reading.cancel()

    async def _read_on(self) -> None:
        while True:
            self._woken.clear()
            try:
                await self._take_in()
            except ServiceError as error:
                _log.warning("events_not_read", code=error.code)
            except Exception:  # noqa: BLE001  without a reader every screen would go on in silence for ever
                _log.exception("events_not_read")
            await comes(self._woken, _POLL_S)

    async def _take_in(self) -> None:
        """Read what is new and tell it; the first time only how far the case is, which the followers compare."""
        if self._newest is None:
            self._newest = await asyncio.to_thread(self._read_newest)
            self._tell()
        while events := await asyncio.to_thread(self._read, self._newest):
            self._tail.extend(events)
            self._newest = events[-1].sequence
            self._tell()

    def _tell(self) -> None:
        told, self.news = self.news, asyncio.Event()
        told.set()
