"""No search for garbage looks through what a process loaded when it started, and its threads take short turns (H32)."""

import gc
import sys
from collections.abc import Iterator

import pytest

from robot.guard.pauses import spare_what_is_loaded, take_short_turns


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


@pytest.mark.hazard("H32")
def test_a_thread_that_calculates_gives_its_turn_away_within_half_a_millisecond() -> None:
    usual_s = sys.getswitchinterval()
    try:
        take_short_turns()
        assert sys.getswitchinterval() == pytest.approx(0.0005)
    finally:
        sys.setswitchinterval(usual_s)
