"""The kernel is asked to tell the guard of its parent's death, and the guard runs where no kernel offers that (H17)."""

import ctypes
import signal
from collections.abc import Iterator

import pytest

from robot.guard.parent import end_with_parent

PR_SET_PDEATHSIG, PR_GET_PDEATHSIG = 1, 2


@pytest.fixture
def library() -> Iterator[ctypes.CDLL]:
    """The process's own; no signal is asked for before and after."""
    library = ctypes.CDLL(None)
    yield library
    library.prctl(PR_SET_PDEATHSIG, 0)


@pytest.mark.hazard("H17")
def test_the_death_of_the_parent_is_a_request_to_end(library: ctypes.CDLL) -> None:
    asked = ctypes.c_int(-1)
    library.prctl(PR_GET_PDEATHSIG, ctypes.byref(asked))
    assert asked.value == 0
    end_with_parent()
    library.prctl(PR_GET_PDEATHSIG, ctypes.byref(asked))
    assert asked.value == signal.SIGTERM


def test_a_system_that_does_not_tell_of_deaths_is_gone_without(
    library: ctypes.CDLL, monkeypatch: pytest.MonkeyPatch
) -> None:
    library.prctl(PR_SET_PDEATHSIG, 0)
    monkeypatch.setattr(ctypes, "CDLL", lambda _: object())
    end_with_parent()
    asked = ctypes.c_int(-1)
    library.prctl(PR_GET_PDEATHSIG, ctypes.byref(asked))
    assert asked.value == 0
