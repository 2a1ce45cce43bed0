"""Events on their way to the service, over a pipe that may be full because nobody reads it."""

import os

from robot.guard.lines import encode
from robot.guard.messages import Event, Status


class Outbox:
    """Never blocks: a status that does not fit is dropped, every other event waits its turn.

    Parameters
    ----------
    descriptor : int
        Write end of a pipe; made non-blocking.
    """

    def __init__(self, descriptor: int) -> None:
        os.set_blocking(descriptor, False)
        self._descriptor = descriptor
        self._waiting = b""
        self.broken = False

    def put(self, event: Event) -> None:
        """Write an event as far as it goes."""
        if not (self._waiting and isinstance(event, Status)):
            self._waiting += encode(event)
        self.push()

    def push(self) -> None:
        """Write what waits as far as it goes; `broken` once nobody holds the other end."""
        try:
            while self._waiting:
                self._waiting = self._waiting[os.write(self._descriptor, self._waiting) :]
        except BlockingIOError:
            pass
        except OSError:
            self.broken = True
