"""What runs on processors of its own in a real room: it may run before the load here."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from robot.guard.precedence import take_precedence


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
