"""Precedence over whatever keeps the processors busy (H32), where the system grants it.

It needs CAP_SYS_NICE or RLIMIT_RTPRIO, the niceness CAP_SYS_NICE or RLIMIT_NICE. Niceness alone does little where the
kernel shares the processors out among sessions first (sched_autogroup).
"""

import os
from contextlib import suppress
from enum import IntEnum
from pathlib import Path

_NICENESS = -10
_THREADS = Path("/proc/self/task")  # a folder for each thread of this process (Linux)


class Precedence(IntEnum):
    """Real-time priorities, of 1 to 99: above all ordinary work, below the kernel's own threads (50)."""

    SERVICE = 5  # carries heartbeats, releases and stops
    GUARD = 10  # stops the arm whatever the service does


def take_precedence(level: Precedence, *, passed_on: bool) -> None:
    """Run the calling thread before all ordinary work, or else before its like; what it starts too, if `passed_on`."""
    _lift(0, level, passed_on=passed_on)


def lift_process(level: Precedence) -> None:
    """The same for every thread of this process, those to come and its children; one that has precedence keeps its own.

    The interpreter runs one thread at a time: whichever it is, the others wait until that one has had its turn, so one
    that does not get a processor would hold up those that do.
    """
    for thread in _threads():
        with suppress(ProcessLookupError):  # a thread may end meanwhile
            if os.sched_getscheduler(thread) == os.SCHED_OTHER:
                _lift(thread, level, passed_on=True)


def stand_back(niceness: int) -> None:
    """Run the calling thread, and what it starts, behind ordinary work, whatever precedence it was started with."""
    if hasattr(os, "sched_setscheduler"):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    os.setpriority(os.PRIO_PROCESS, 0, niceness)


def _lift(thread: int, level: Precedence, *, passed_on: bool) -> None:
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, thread, _NICENESS)
    with suppress(PermissionError, AttributeError):  # there is no such policy outside Linux
        policy = os.SCHED_RR if passed_on else os.SCHED_RR | os.SCHED_RESET_ON_FORK
        os.sched_setscheduler(thread, policy, os.sched_param(level))


def _threads() -> list[int]:
    return [int(folder.name) for folder in _THREADS.iterdir()] if _THREADS.is_dir() else []
