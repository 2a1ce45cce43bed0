"""The service's death as the kernel tells it: long before the pipe closes (H17)."""

import ctypes
import signal

_PR_SET_PDEATHSIG = 1  # prctl(2), Linux


def end_with_parent() -> None:
    """Have SIGTERM sent to this process as soon as the thread that started it is dead.

    A process that is killed closes its pipes after the last of its threads has torn its memory down, which takes tens
    of milliseconds; each other thread dies at once, and its children are told. Where no system offers this, the pipe
    alone tells.
    """
    prctl = getattr(ctypes.CDLL(None), "prctl", None)
    if prctl is not None:
        prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
