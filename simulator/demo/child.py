"""A process that the demonstration started, with a log of its own; ended by its id."""

import os
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Self

from simulator.demo.failure import DemoFailed

_LOOK_EVERY_S = 0.05
_END_WITHIN_S = 15.0
_LINES_SHOWN = 5


def coaxial(*arguments: str) -> list[str]:
    """The command line of a `coaxial` subcommand: the command installed beside this interpreter."""
    return [str(Path(sys.executable).with_name("coaxial")), *arguments]


def clean_environment(**more: str) -> dict[str, str]:
    """This environment without the caller's own Coaxial settings; those in files would lose against them."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("COAXIAL_")}
    # Many small matrices: threads of the linear algebra only fight over the cores.
    return {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"} | kept | more


class Child:
    """A running process; leaving the context ends it."""

    def __init__(self, name: str, command: Sequence[str], log: Path, environment: Mapping[str, str]) -> None:
        self.name = name
        self.log = log
        with log.open("wb") as output:  # a line of an earlier start must not pass for one of this
            # A process group of its own: Ctrl-C reaches the demonstration alone, which ends the rest in order.
            self._process = subprocess.Popen(  # noqa: S603  our own commands
                command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, env=environment, process_group=0
            )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    @property
    def ended(self) -> bool:
        """Whether it is gone."""
        return self._process.poll() is not None

    def says(self, beginning: str, timeout_s: float) -> str:
        """The rest of the first line in the log that begins so; DemoFailed if the process ends or is late."""
        end_s = time.monotonic() + timeout_s
        while time.monotonic() < end_s:
            for line in self._lines():
                if line.startswith(beginning):
                    return line.removeprefix(beginning).strip()
            if self.ended:
                raise DemoFailed(f"{self.name}_ended", self.last_words())
            time.sleep(_LOOK_EVERY_S)
        raise DemoFailed(f"{self.name}_late", f"not up after {timeout_s:g} s; see {self.log}")

    def last_words(self) -> str:
        """How it ended, with the end of its log."""
        lines = self._lines()[-_LINES_SHOWN:]
        return " | ".join([f"exit status {self._process.poll()}", *lines, f"see {self.log}"])

    def _lines(self) -> list[str]:
        return self.log.read_text(encoding="utf-8", errors="replace").splitlines()

    def end(self) -> None:
        """Ask it to end, then make it."""
        if self.ended:
            return
        self._process.terminate()
        try:
            self._process.wait(_END_WITHIN_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
