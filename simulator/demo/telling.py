"""Progress as it happens: a spinner at a terminal, plain lines in a pipe."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console

_WIDTH_IN_A_PIPE = 132


def open_console() -> Console:
    """Standard output; wide enough for the table where nobody can say how wide it is."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=_WIDTH_IN_A_PIPE)


class Teller:
    """Tells each step with the time since the start and what it is about."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self.about = ""
        self._started_s = time.monotonic()

    def elapsed_s(self) -> float:
        """Since the start."""
        return time.monotonic() - self._started_s

    @contextmanager
    def doing(self, what: str) -> Iterator[None]:
        """While something takes its time."""
        with self.console.status(f"{self.about}  {what} ..."):
            yield

    def tell(self, what: str) -> None:
        """What is done."""
        minutes, seconds = divmod(self.elapsed_s(), 60.0)
        self.console.print(f"{minutes:2.0f}:{seconds:04.1f}  {self.about:<10} {what}", soft_wrap=True, markup=False)
