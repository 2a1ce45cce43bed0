"""The held button as a scripted client presses it: a heartbeat for each challenge, as soon as that comes.

What waited for a beat of its own would be older by that wait when it is back, and age is what the guard judges.

One thread alone reads and writes: OpenSSL bears no two on one connection. Where one read the tickets that TLS 1.3 sends
behind its handshake while another wrote, what was written was lost.
"""

import asyncio
import json
import ssl
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus

from coaxial_client.answers import NoAnswer, Refused

_OPENED_WITHIN_S = 10.0
_ENDED_WITHIN_S = 5.0  # of letting go; the arm itself has stopped long before


@dataclass(frozen=True, slots=True)
class Button:
    """Where a button is to be held, who holds it, and for how long at most."""

    url: str
    token: str
    tls: ssl.SSLContext | None
    longest_s: float


@dataclass(frozen=True, slots=True)
class HoldEnded:
    """How the motion ended: the cause that was observed, where the case stands, and how far from the goal."""

    cause: str  # arrived, released, stopped, heartbeat_lost, ...
    state: str
    version: int
    distance_mm: float | None
    angle_deg: float | None
    problem: dict[str, Any] | None  # where the start was refused


class Hold:
    """A pressed button: entering the context presses it, and leaving the context lets go, whatever the reason.

    Nothing is sent without a challenge that the guard made. A program that ends, is killed or loses its network is
    silent, and silence stops the arm; one that is merely stuck inside the context lets go after the longest time.
    A motion that has ended is never resumed.
    """

    def __init__(self, button: Button, on_ended: Callable[[HoldEnded], None]) -> None:
        self._button = button
        self._on_ended = on_ended
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._connection: ClientConnection | None = None
        self._held = True
        self._silent = False
        self._number = 0
        self._challenge = ""
        self._ended: HoldEnded | None = None
        self._over = threading.Event()
        self.progress: dict[str, Any] = {}

    def __enter__(self) -> Self:
        self._loop = asyncio.new_event_loop()
        self._thread.start()
        try:
            self._connection = asyncio.run_coroutine_threadsafe(_connected(self._button), self._loop).result()
            asyncio.run_coroutine_threadsafe(self._listen(self._connection), self._loop)
        except BaseException:  # an interrupt meanwhile must not leave a button pressed
            self._let_go()
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._let_go()

    def _let_go(self) -> None:
        if self._connection is not None and not self._over.is_set():
            self.release()
            self._over.wait(_ENDED_WITHIN_S)
        self._over.set()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(_ENDED_WITHIN_S)

    def _run(self) -> None:
        with asyncio.Runner(loop_factory=lambda: self._loop) as runner:
            runner.get_loop().run_forever()

    @property
    def is_over(self) -> bool:
        """Whether the motion has ended, or the connection."""
        return self._over.is_set()

    def release(self) -> None:
        """Let go: said at once, not only by silence."""
        self._held = False
        if self._thread.is_alive():  # else nothing was pressed yet, or all is over
            with suppress(RuntimeError):  # the context is being left meanwhile
                self._loop.call_soon_threadsafe(self._say_released)

    def fall_silent(self) -> None:
        """Send nothing any more, as a lost network would; what comes in is still heard."""
        self._silent = True

    def wait(self, timeout_s: float) -> HoldEnded:
        """Hold until the motion is over, wherever it ended.

        Raises
        ------
        TimeoutError
            It is not over after `timeout_s`; leaving the context stops it.
        NoAnswer
            The connection broke, which stops the arm.
        """
        if not self._over.wait(timeout_s):
            raise TimeoutError(f"the motion did not end within {timeout_s} s")
        if self._ended is None:
            raise NoAnswer("the connection of the held button broke: silence stops the arm")
        return self._ended

    def _say_released(self) -> None:
        self._releasing = self._loop.create_task(self._send())  # kept: a task that nobody holds may vanish

    async def _listen(self, connection: ClientConnection) -> None:
        self._loop.call_later(self._button.longest_s, self.release)
        try:
            with suppress(ConnectionClosed, OSError):
                async for text in connection:
                    await self._take(json.loads(text))
        finally:
            self._over.set()
            await connection.close()

    async def _send(self) -> None:
        if self._connection is None or not self._challenge or self._over.is_set():
            return
        self._number += 1
        beat = {"number": self._number, "challenge": self._challenge, "held": self._held}
        with suppress(ConnectionClosed, OSError):  # the ending may have come, and not have been read yet
            await self._connection.send(json.dumps(beat))

    async def _take(self, message: dict[str, Any]) -> None:
        if message["type"] == "progress":
            self._challenge = message["challenge"]
            self.progress = message
            if self._held and not self._silent:
                await self._send()
            return
        self._ended = HoldEnded(
            cause=message["cause"],
            state=message["state"],
            version=message["version"],
            distance_mm=message["distance_mm"],
            angle_deg=message["angle_deg"],
            problem=message["problem"],
        )
        self._on_ended(self._ended)
        self._over.set()


async def _connected(button: Button) -> ClientConnection:
    headers = {"Authorization": f"Bearer {button.token}"}
    try:
        return await connect(
            button.url,
            ssl=button.tls,
            additional_headers=headers,
            open_timeout=_OPENED_WITHIN_S,
            close_timeout=_ENDED_WITHIN_S,
            ping_interval=None,
            proxy=None,
        )
    except InvalidStatus as refusal:
        raise Refused.from_body(refusal.response.status_code, refusal.response.body or b"") from None
    except (OSError, InvalidHandshake) as error:
        raise NoAnswer(f"the held button: {type(error).__name__} {error}") from error
