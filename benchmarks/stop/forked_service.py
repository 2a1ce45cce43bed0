"""`coaxial serve` forked from a process that has imported everything already, so that thousands can be killed.

    python -m benchmarks.stop.forked_service

Takes orders from its input, a JSON line each, and ends with it; a service that was forked goes on.
"""

import json
import os
import select
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.system.service_process import Service

_STARTS_WITHIN_S = 60.0
_ENDS_WITHIN_S = 20.0
_LOOK_S = 0.01
_LISTENS = "Coaxial listens on "


class Nursery:
    """The process that services are forked from."""

    def __init__(self) -> None:
        command = [sys.executable, "-m", "benchmarks.stop.forked_service"]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def close(self) -> None:
        """End it; what it forked goes on."""
        self._process.communicate(timeout=_ENDS_WITHIN_S)

    def fork(self, **order: Any) -> int:
        """Fork a service; its process's id."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(json.dumps(order), file=self._process.stdin, flush=True)
        return int(self._process.stdout.readline())


@dataclass
class ForkedService(Service):
    """A `Service` whose process is forked; the first start waits until everything is imported."""

    nursery: Nursery = field(kw_only=True)
    _death: int = field(init=False, default=-1)  # a descriptor that can be read once the process is dead

    def start(self) -> None:
        """Start, and wait for the address."""
        said = self.folder / "said"
        said.write_text("")
        if self._death >= 0:
            os.close(self._death)
        log = str(self.folder / "log")
        self._death = os.pidfd_open(self.nursery.fork(environment=self.environment(), said=str(said), log=log))
        self.url = self._told(said)

    def kill(self) -> None:
        """As a power switch would."""
        self._send(signal.SIGKILL)

    def end(self) -> None:
        """As an operator would."""
        self._send(signal.SIGTERM)

    def _send(self, number: signal.Signals) -> None:
        with suppress(ProcessLookupError):
            signal.pidfd_send_signal(self._death, number)
        assert self._is_dead(_ENDS_WITHIN_S), f"the service outlives a {number.name}"

    def _told(self, said: Path) -> str:
        end_s = time.monotonic() + _STARTS_WITHIN_S
        while not (text := said.read_text()).endswith("\n"):
            assert not self._is_dead(_LOOK_S), self.log()
            assert time.monotonic() < end_s, "the service does not start"
        return text.removeprefix(_LISTENS).strip()

    def _is_dead(self, within_s: float) -> bool:
        return bool(select.select([self._death], [], [], within_s)[0])


def serve(environment: dict[str, str], said: str, log: str) -> None:
    """Run the service in this process."""
    from service.cli.main import main

    for descriptor, path, flags in ((0, os.devnull, os.O_RDONLY), (1, said, os.O_WRONLY), (2, log, os.O_WRONLY)):
        opened = os.open(path, flags | (os.O_APPEND | os.O_CREAT if descriptor else 0))
        os.dup2(opened, descriptor)
        os.close(opened)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ["coaxial", "serve"]
    main()


def fork_services() -> None:
    """Import what a service does, then fork one for each order."""
    import service.cli.main
    import service.cli.serve
    import service.serving  # noqa: F401  # all of it for the children

    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for them here
    for line in sys.stdin:
        pid = os.fork()
        if pid == 0:
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            serve(**json.loads(line))
        print(pid, flush=True)


if __name__ == "__main__":
    fork_services()
