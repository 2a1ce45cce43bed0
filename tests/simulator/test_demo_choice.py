"""Which pedicles a demonstration goes to."""

import pytest

from simulator.demo.door_client import PlannedPedicle
from simulator.demo.failure import DemoFailed
from simulator.demo.run import choose

ROOM = [PlannedPedicle(name, (0.0, 50.0, 0.0), (0.0, 0.0, 0.0)) for name in ("L3-left", "L3-right", "L5-left")]


def test_those_that_were_asked_for_in_their_order() -> None:
    assert [one.name for one in choose(ROOM, ["L5-left", "L3-left"])] == ["L5-left", "L3-left"]


def test_all_of_a_room_that_has_not_the_usual_ones() -> None:
    assert choose(ROOM, []) == ROOM


def test_an_unknown_one_is_refused_with_those_there_are() -> None:
    with pytest.raises(DemoFailed) as failed:
        choose(ROOM, ["L3-left", "C7-left"])
    assert failed.value.code == "pedicle_unknown"
    assert str(failed.value).count("C7-left") == 1
    assert "L3-left, L3-right, L5-left" in str(failed.value)
