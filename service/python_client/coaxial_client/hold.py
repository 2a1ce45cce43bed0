"""The held button as a scripted client presses it: a heartbeat for each challenge, as soon as that comes.

What waited for a beat of its own would be older by that wait when it is back, and age is what the guard judges.
"""

import json
import ssl
import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus
from websockets.sync.client import ClientConnection, connect

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
        self._open = ExitStack()
        self._listening = threading.Thread(target=self._listen, daemon=True)
        self._longest = threading.Timer(button.longest_s, self.release)
        self._longest.daemon = True
        self._lock = threading.Lock()
        self._held = True
        self._silent = False
        self._number = 0
        self._challenge = ""
        self._ended: HoldEnded | None = None
        self._over = threading.Event()
        self.progress: dict[str, Any] = {}

    def __enter__(self) -> Self:
        self._connection = self._open.enter_context(_connected(self._button))
        try:
            self._listening.start()
            self._longest.start()
        except BaseException:  # an interrupt between the two must not leave a button pressed
            self._let_go()
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._let_go()

    def _let_go(self) -> None:
        if not self._over.is_set():
            self.release()
            self._over.wait(_ENDED_WITHIN_S)
        self._over.set()
        self._longest.cancel()
        self._open.close()
        if self._listening.ident is not None:
            self._listening.join(_ENDED_WITHIN_S)

    @property
    def is_over(self) -> bool:
        """Whether the motion has ended, or the connection."""
        return self._over.is_set()

    def release(self) -> None:
        """Let go: said at once, not only by silence."""
        self._held = False
        self._send()

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

    def _send(self) -> None:
        with self._lock:
            if not self._challenge or self._over.is_set():
                return
            self._number += 1
            beat = {"number": self._number, "challenge": self._challenge, "held": self._held}
            with suppress(ConnectionClosed, OSError):  # the ending may have come, and not have been read yet
                self._connection.send(json.dumps(beat))

    def _listen(self) -> None:
        try:
            for text in self._connection:
                self._take(json.loads(text))
        except (ConnectionClosed, OSError):
            pass
        finally:
            self._over.set()

    def _take(self, message: dict[str, Any]) -> None:
        if message["type"] == "progress":
            self._challenge = message["challenge"]
            self.progress = message
            if self._held and not self._silent:
                self._send()
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


def _connected(button: Button) -> ClientConnection:
    headers = {"Authorization": f"Bearer {button.token}"}
    try:
        return connect(
            button.url,
            ssl=button.tls,
            additional_headers=headers,
            open_timeout=_OPENED_WITHIN_S,
            ping_interval=None,
            proxy=None,
        )
    except InvalidStatus as refusal:
        raise Refused.from_body(refusal.response.status_code, refusal.response.body or b"") from None
    except (OSError, InvalidHandshake) as error:
        raise NoAnswer(f"the held button: {type(error).__name__} {error}") from error
