"""What runs on processors of its own in a real room: it may run before the load here."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from robot.guard.precedence import take_precedence

_RANK = 10  # the guard's


def put_ahead(process_id: int) -> None:
    """A process that is up: what it imports while it starts, at that rank, would be no part of a real room's load."""
    with suppress(PermissionError):
        for thread in Path(f"/proc/{process_id}/task").iterdir():
            os.sched_setscheduler(int(thread.name), os.SCHED_RR, os.sched_param(_RANK))


@contextmanager
def ahead() -> Iterator[None]:
    """This thread, and what it starts, run before ordinary work, where the system grants it."""
    niceness = os.getpriority(os.PRIO_PROCESS, 0)
    take_precedence(passed_on=True)
    try:
        yield
    finally:
        with suppress(PermissionError):
            os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
            os.setpriority(os.PRIO_PROCESS, 0, niceness)
