"""No search for garbage looks through what a process loaded when it started (H32)."""

import gc
from collections.abc import Iterator

import pytest

from robot.guard.pauses import spare_what_is_loaded


@pytest.fixture
def spared() -> Iterator[list]:
    """Something that was there before; the interpreter of the tests searches everything again afterwards."""
    there: list = []
    spare_what_is_loaded()
    yield there
    gc.unfreeze()


@pytest.mark.hazard("H32")
def test_what_is_loaded_is_searched_no_more_and_what_comes_later_is(spared) -> None:
    later: list = []
    searched = {id(thing) for thing in gc.get_objects()}
    assert id(spared) not in searched
    assert id(later) in searched
