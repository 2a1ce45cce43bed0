"""The network between a tablet and the service: a relay that can be cut, so that nobody hears anything any more."""

import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from urllib.parse import urlsplit

_BLOCK = 65_536


class Cable:
    """Carries connections to one service; cut, it holds them open and swallows what is sent."""

    def __init__(self, service_url: str) -> None:
        self._far = urlsplit(service_url).hostname or "", urlsplit(service_url).port or 80
        self._near = socket.create_server(("127.0.0.1", 0))
        self._whole = threading.Event()
        self._whole.set()
        self._ends: list[socket.socket] = [self._near]
        self.url = f"http://127.0.0.1:{self._near.getsockname()[1]}"
        _start(self._accept)

    def cut(self) -> None:
        """From now on nothing comes through, and nobody is told."""
        self._whole.clear()

    def close(self) -> None:
        """All connections ended."""
        for end in self._ends:
            with suppress(OSError):  # the other side may have gone first
                end.shutdown(socket.SHUT_RDWR)
            end.close()

    def _accept(self) -> None:
        with suppress(OSError):  # closed
            while True:
                near, _ = self._near.accept()
                far = socket.create_connection(self._far)
                self._ends += [near, far]
                _start(self._carry, near, far)
                _start(self._carry, far, near)

    def _carry(self, source: socket.socket, sink: socket.socket) -> None:
        with suppress(OSError):  # either side has gone
            while block := source.recv(_BLOCK):
                if self._whole.is_set():
                    sink.sendall(block)
            sink.shutdown(socket.SHUT_WR)


@contextmanager
def cable_to(service_url: str) -> Iterator[Cable]:
    """A whole cable, gone with the block."""
    cable = Cable(service_url)
    try:
        yield cable
    finally:
        cable.close()


def _start(run: Callable[..., None], *arguments: socket.socket) -> None:
    threading.Thread(target=run, args=arguments, daemon=True).start()
