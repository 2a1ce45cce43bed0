"""One guard process as its parent holds it: two pipes and an end."""

import os
import select
import subprocess
import sys
from pathlib import Path
from threading import Lock, Thread
from typing import BinaryIO, cast

import structlog

_END_S = 4.0  # a guard that stops a moving arm waits for its rest
_log = structlog.get_logger()


class GuardChild:
    """A guard process; it runs in a session of its own, outlives a terminal's interrupt and stops the arm.

    The pipes are close-on-exec, so that no other child of this process keeps them open when it dies (H17).
    """

    def __init__(self, arm_address: str, journal_folder: Path) -> None:
        command = [sys.executable, "-m", "robot.guard", "--arm", arm_address, "--journal", str(journal_folder)]
        said, saying = os.pipe()
        os.set_blocking(saying, False)  # what nobody takes is lost: a guard must never wait to be heard (H17)
        try:
            self._process = subprocess.Popen(  # noqa: S603  # our own module, no shell
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=saying,
                bufsize=0,
                start_new_session=True,
            )
        except OSError:
            os.close(said)
            raise
        finally:
            os.close(saying)
        Thread(target=_log_what_is_said, args=(said, self.pid), name="guard's words", daemon=True).start()
        self._commands = cast(BinaryIO, self._process.stdin)
        self._events = cast(BinaryIO, self._process.stdout)
        self._arriving = select.poll()  # `select` counts descriptors to 1024 only: a service of many screens has more
        self._arriving.register(self._events, select.POLLIN)
        self._rest = b""
        self._lock = Lock()
        os.set_blocking(self._commands.fileno(), False)

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    def send(self, line: bytes) -> bool:
        """Write a line whole or not at all: a pipe takes up to 4 kB at once, and a full one takes nothing."""
        with self._lock:
            try:
                return not self._commands.closed and os.write(self._commands.fileno(), line) == len(line)
            except OSError:
                return False

    def read(self, timeout_s: float) -> list[bytes] | None:
        """Lines that arrived, perhaps none; None once the process has closed its end."""
        if not self._arriving.poll(timeout_s * 1000.0):
            return []
        part = os.read(self._events.fileno(), 65536)
        *lines, self._rest = (self._rest + part).split(b"\n")
        return lines if part else None

    def dismiss(self) -> None:
        """Close the command pipe: the guard stops the arm, waits for its rest and exits."""
        with self._lock:
            self._commands.close()

    def end(self, at_once: bool) -> None:
        """Wait for the exit, or enforce it."""
        if at_once:
            self._process.kill()
        try:
            self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self.dismiss()
        self._events.close()


def _log_what_is_said(said: int, pid: int) -> None:
    """Log each line that the arm's library or a fault prints, until the guard's end; it knows of no patient."""
    rest = b""
    while part := os.read(said, 4096):
        *lines, rest = (rest + part).split(b"\n")
        for line in filter(bytes.strip, lines):
            _log.warning("guard_said", pid=pid, said=line.decode(errors="replace").strip())
    os.close(said)
