"""A fork that runs tests until the first failure, and what came of it.

A fork of an interpreter that has loaded everything costs milliseconds, a new one seconds.
"""

import json
import os
import resource
import select
import signal
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path

PROCESSOR_S = 60  # several times what all tests of a package take
_ELAPSED = 5  # times as much by the clock: of one that neither works nor sleeps for long
_MEMORY_BYTES = 8 << 30
_LOOK_S = 1.0
_told_to = -1  # of this fork: the pipe to its parent
_ASLEEP_S = 8.0  # no thread of it runs or wants to: it waits for what never comes
_IDLE = 0.02  # of a processor, for looking again and again whether it has come


class Status(StrEnum):
    """What became of a mutant."""

    KILLED = "killed"
    ENDLESS = "endless"  # it never ended, which a test run would notice
    STILLBORN = "stillborn"  # Python itself refuses to load it
    SURVIVED = "survived"
    UNREACHED = "unreached"  # no test runs the line
    ELSEWHERE = "elsewhere"  # it cannot be changed in place


@dataclass(frozen=True, slots=True)
class Outcome:
    """By which test, if by any."""

    status: Status
    by: str = ""


class HarnessError(Exception):
    """What should try mutants failed by itself."""


def quiet() -> None:
    """Nothing of this process reaches the terminal."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)


def forked(run: Callable[[], Outcome], processor_s: int = PROCESSOR_S) -> Outcome:
    """The outcome of `run` in a fork of this process, which may also tell one early by `leave`."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        _be_child(run, writing, processor_s)
    os.close(writing)
    told = _wait(child, reading, _ELAPSED * processor_s)
    os.close(reading)
    if "error" in told:
        raise HarnessError(told["error"])
    return Outcome(Status(told["status"]), told["by"])


def leave(outcome: Outcome) -> None:
    """Tell this outcome and end the fork at once."""
    _tell(asdict(outcome))
    os._exit(0)


def _tell(what: dict[str, str]) -> None:
    os.write(_told_to, json.dumps(what).encode())


def _be_child(run: Callable[[], Outcome], writing: int, processor_s: int) -> None:
    global _told_to
    _told_to = writing
    os.setsid()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_CPU, (processor_s, processor_s))
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY_BYTES, _MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        quiet()
        leave(run())
    except BaseException:  # noqa: BLE001  # a fork must never go on as its parent would
        _tell({"error": traceback.format_exc()[-2000:]})
    os._exit(1)


def _wait(child: int, reading: int, elapsed_s: float) -> dict[str, str]:
    """What the child tells; one that ends without a word was killed, one that sleeps or goes on for long is endless."""
    try:
        for over in _looks(child, elapsed_s):
            ready, _, _ = select.select([reading], [], [], _LOOK_S)
            if ready or over:
                break
        told = os.read(reading, 65536) if ready else b""
    finally:
        with suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    if told:
        return dict(json.loads(told))
    endless = not ready or (os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU)
    return {"status": Status.ENDLESS if endless else Status.KILLED, "by": "" if endless else "the process ended"}


def _looks(child: int, elapsed_s: float) -> Iterator[bool]:
    """Whether all of the child has been idle for long, or its time is over, again and again."""
    began_s = since_s = time.monotonic()
    before_s = 0.0
    while True:
        spent_s, running = _activity(child)
        if running or spent_s - before_s > _IDLE * _ASLEEP_S:
            before_s, since_s = spent_s, time.monotonic()
        yield time.monotonic() - since_s > _ASLEEP_S or time.monotonic() - began_s > elapsed_s


def _activity(process: int) -> tuple[float, bool]:
    """Processor time of all its threads, and whether one of them runs or wants to; threads come and go meanwhile."""
    running = False
    for thread in Path(f"/proc/{process}/task").iterdir():
        with suppress(FileNotFoundError, ProcessLookupError):
            running |= _fields(thread)[0] == "R"
    user, system = _fields(Path(f"/proc/{process}"))[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK"), running


def _fields(place: Path) -> list[str]:
    """Of its status, those behind the name: the state first."""
    return (place / "stat").read_text().rpartition(")")[2].split()
