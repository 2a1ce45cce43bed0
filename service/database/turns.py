"""Whose turn it is to write: one writer of this process at a time, and images behind everything else.

SQLite lets waiting writers ask again and again, whoever asks at the right moment; beside four senders of images the
approval of a motion waited for half a second.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from service.errors import ErrorCode, ServiceError


class Turns:
    """Writers wait here, not at the database."""

    def __init__(self, patience_s: float) -> None:
        self._patience_s = patience_s
        self._changed = threading.Condition()
        self._taken = False
        self._ahead = 0  # writers that wait and are no images

    @contextmanager
    def taken(self, *, bulky: bool) -> Iterator[None]:
        """Write within the block; ServiceError DATABASE_BUSY where the turn does not come in time."""
        with self._changed:
            self._wait(bulky=bulky)
            self._taken = True
        try:
            yield
        finally:
            with self._changed:
                self._taken = False
                self._changed.notify_all()

    def _wait(self, *, bulky: bool) -> None:
        self._ahead += not bulky
        try:
            free = self._changed.wait_for(lambda: not self._taken and not (bulky and self._ahead), self._patience_s)
        finally:
            self._ahead -= not bulky
        if not free:
            message = "other writers held the database too long"
            raise ServiceError(ErrorCode.DATABASE_BUSY, message, limit=self._patience_s)
