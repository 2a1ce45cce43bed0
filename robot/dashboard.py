"""A tiny dashboard client: newline ASCII, for a stop that depends on nothing else."""

import socket
import time
from threading import Lock

DASHBOARD_PORT = 29999
_CONNECT_S = 0.5  # on a wired network of one room a controller answers in a millisecond
_STOPPED = b"Stopped"
_MOST_ANSWER = 4096  # bytes of the banner and an answer, which take a hundred
_MOST_READS = 64  # of what was answered since: a stop a second for a minute


class DashboardLink:
    """A dashboard connection that is kept open, so that a stop costs one write; `send_stop` from any thread."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._socket: socket.socket | None = None
        self._lock = Lock()

    def send_stop(self) -> bool:
        """Write `stop` without awaiting the answer; a connection that was closed from afar is opened anew first."""
        with self._lock:
            if not self._is_open() and not self._open():
                return False
            return self._write(b"stop\n")

    def close(self) -> None:
        """Close the connection."""
        with self._lock:
            self._drop()

    def _is_open(self) -> bool:
        """Read away what was answered: only so does a close from afar show before something is written in vain."""
        if self._socket is None:
            return False
        try:
            for _ in range(_MOST_READS):  # who talks without end keeps no stop waiting
                if not self._socket.recv(_MOST_ANSWER):
                    break
        except BlockingIOError:
            return True
        except OSError:
            pass
        self._drop()
        return False

    def _open(self) -> bool:
        try:
            self._socket = socket.create_connection((self._address, DASHBOARD_PORT), _CONNECT_S)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._socket.setblocking(False)  # five bytes always fit: a full buffer means that nobody reads them
        except OSError:
            self._drop()
            return False
        return True

    def _write(self, line: bytes) -> bool:
        try:
            if self._socket is not None:
                self._socket.sendall(line)
                return True
        except OSError:
            self._drop()
        return False

    def _drop(self) -> None:
        if self._socket is not None:
            self._socket.close()
            self._socket = None


def stop_by_dashboard(address: str, timeout_s: float = 1.0) -> bool:
    """Connect, send `stop`, close; True if the controller answered `Stopped`. Raises nothing on network faults.

    Parameters
    ----------
    timeout_s : float
        Of the connection, and of the whole answer.
    """
    try:
        with socket.create_connection((address, DASHBOARD_PORT), timeout_s) as connection:
            connection.sendall(b"stop\n")  # the banner is not awaited: the stop goes first
            return _answers(connection, time.monotonic() + timeout_s)
    except OSError:
        return False


def _answers(connection: socket.socket, end_s: float) -> bool:
    """Whether it says so until the monotonic time `end_s`, however slowly; OSError where it is silent."""
    answer = b""
    while _STOPPED not in answer and len(answer) < _MOST_ANSWER and (left_s := end_s - time.monotonic()) > 0.0:
        connection.settimeout(left_s)
        if not (part := connection.recv(_MOST_ANSWER)):
            break
        answer += part
    return _STOPPED in answer
