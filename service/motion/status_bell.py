"""Wakes whoever waits for the guard's next status, so that its challenge travels on without a pause in between."""

import asyncio


class StatusBell:
    """Rung from the thread that hears the guard, heard on the event loop."""

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._next: asyncio.Future[None] = self._loop.create_future()

    def ring(self) -> None:
        """A status came; from any thread."""
        self._loop.call_soon_threadsafe(self._ring)

    async def wait(self) -> None:
        """Wait for the next ring."""
        await asyncio.shield(self._next)

    def _ring(self) -> None:
        rung, self._next = self._next, self._loop.create_future()
        rung.set_result(None)
