"""Waiting for what comes to be in its own time: the one loop of all tests that ask again and again."""

import time
from collections.abc import Callable

_LOOK_S = 0.01


def until(condition: Callable[[], object], within_s: float = 20.0, seen: Callable[[], object] | None = None) -> None:
    """Wait for a condition, or fail with what `seen` tells of the time meanwhile."""
    end_s = time.monotonic() + within_s
    while not condition():
        assert time.monotonic() < end_s, "it did not come to that" if seen is None else seen()
        time.sleep(_LOOK_S)
