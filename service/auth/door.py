"""Where those wait who say who they are: one at a time, few behind, and nobody else is asked to come back."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import BoundedSemaphore, Lock

from service.errors import ErrorCode, ServiceError

# A quarter of a second each. Every one who waits has a thread of the forty that requests share.
MOST_AT_THE_DOOR = 8


class Door:
    """Anybody may knock: what that costs is bounded, however many do (H32)."""

    def __init__(self) -> None:
        self._places = BoundedSemaphore(MOST_AT_THE_DOOR)
        self._turn = Lock()

    @contextmanager
    def turn(self) -> Iterator[None]:
        """One's turn, waited for; ServiceError SIGN_IN_BUSY at once where too many wait."""
        if not self._places.acquire(blocking=False):
            raise ServiceError(ErrorCode.SIGN_IN_BUSY, "too many are signing in", limit=MOST_AT_THE_DOOR)
        try:
            with self._turn:
                yield
        finally:
            self._places.release()
