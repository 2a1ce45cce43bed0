"""The held button as a scripted client presses it: heartbeats from a thread, each echoing the newest challenge."""

import json
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from service.client_refused import Refused

HEARTBEAT_S = 0.05


@dataclass(frozen=True, slots=True)
class HoldEnded:
    """How the motion ended: the cause that was observed, where the case stands, and how far from the goal."""

    cause: str
    state: str
    version: int
    distance_mm: float | None
    angle_deg: float | None
    problem: dict[str, Any] | None


class Hold:
    """A pressed button; leaving the context lets go.

    Nothing is sent without a challenge that the guard made, and nothing is sent by anything but this thread: if the
    program that holds is stuck, so is the thread's process, and the arm stops.
    """

    def __init__(self, url: str, token: str, on_ended: Callable[[HoldEnded], None]) -> None:
        self._url = url
        self._on_ended = on_ended
        self._token = token
        self._open = ExitStack()
        self._threads: list[threading.Thread] = []
        self._lock = threading.Lock()
        self._held = True
        self._silent = False
        self._number = 0
        self._challenge = ""
        self._ended: HoldEnded | None = None
        self._over = threading.Event()
        self.progress: dict[str, Any] = {}

    def __enter__(self) -> Self:
        headers = {"Authorization": f"Bearer {self._token}"}
        try:
            opening = connect(self._url, additional_headers=headers, open_timeout=10, ping_interval=None)
            self._connection = self._open.enter_context(opening)
        except InvalidStatus as refusal:
            raise Refused.from_body(refusal.response.status_code, refusal.response.body or b"") from None
        for run in (self._listen, self._beat):
            self._threads.append(threading.Thread(target=run, daemon=True))
            self._threads[-1].start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if not self._over.is_set():
            self.release()
            self._over.wait(5.0)
        self._over.set()
        self._open.close()
        for thread in self._threads:
            thread.join(5.0)

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
        """Hold until the motion is over; TimeoutError after `timeout_s`."""
        if not self._over.wait(timeout_s) or self._ended is None:
            raise TimeoutError(f"the motion did not end within {timeout_s} s")
        return self._ended

    def _beat(self) -> None:
        due_s = time.monotonic()
        while not self._over.is_set() and self._held and not self._silent:
            self._send()
            due_s += HEARTBEAT_S
            self._over.wait(max(0.0, due_s - time.monotonic()))

    def _send(self) -> None:
        with self._lock:
            if not self._challenge or self._over.is_set():
                return
            self._number += 1
            beat = {"number": self._number, "challenge": self._challenge, "held": self._held}
            try:
                self._connection.send(json.dumps(beat))
            except (ConnectionClosed, OSError):
                self._over.set()

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
