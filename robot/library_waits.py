"""Descriptors on which ur-rtde waits for its sockets and clocks: it leaves them open until its destructor runs.

The guard never lets that run, which stops every thread for half a second, and each motion would cost nine of them.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_OPEN = Path("/proc/self/fd")
# What the library's event loops are made of; nothing else in the guard is made of them.
_KINDS = frozenset({"anon_inode:[eventpoll]", "anon_inode:[eventfd]", "anon_inode:[timerfd]"})


class Waits:
    """Those of an interface that is no more used: no thread of the library is left to wait on them."""

    def __init__(self) -> None:
        self._descriptors: frozenset[int] = frozenset()

    @contextmanager
    def noted(self) -> Iterator[None]:
        """The block makes an interface; no thread of Python's runs meanwhile, so that what is new is the library's."""
        before = _waits()
        yield
        self._descriptors |= _waits() - before

    def close(self) -> None:
        """Close what was noted, once the interface's connections are closed and its threads have ended."""
        descriptors, self._descriptors = self._descriptors, frozenset()
        for descriptor in descriptors:
            os.close(descriptor)


def _waits() -> frozenset[int]:
    return frozenset(int(one.name) for one in _OPEN.iterdir() if _kind(one) in _KINDS)


def _kind(descriptor: Path) -> str:
    try:
        return str(descriptor.readlink())
    except FileNotFoundError:  # the listing's own, or closed meanwhile
        return ""
