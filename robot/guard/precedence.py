"""Precedence over whatever keeps the processors busy (H32), where the system grants it."""

import os
from contextlib import suppress

_PRIORITY = 10  # of 1 to 99: above all ordinary work, below the kernel's own threads (50)
_NICENESS = -10


def take_precedence(*, passed_on: bool) -> None:
    """Run the calling thread before all ordinary work, or else before its like; what it starts too, if `passed_on`.

    The first needs CAP_SYS_NICE or RLIMIT_RTPRIO, the second CAP_SYS_NICE or RLIMIT_NICE. Niceness alone does little
    where the kernel shares the processors out among sessions first (sched_autogroup).
    """
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, _NICENESS)
    with suppress(PermissionError, AttributeError):  # there is no such policy outside Linux
        policy = os.SCHED_RR if passed_on else os.SCHED_RR | os.SCHED_RESET_ON_FORK
        os.sched_setscheduler(0, policy, os.sched_param(_PRIORITY))
