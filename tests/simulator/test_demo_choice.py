"""Which pedicles a demonstration goes to, and what it refuses before it starts anything."""

import pytest
from rich.console import Console

from simulator.demo.door_client import PlannedPedicle
from simulator.demo.failure import DemoFailed
from simulator.demo.run import choose
from simulator.demo.stage import open_stage
from simulator.demo.telling import Teller

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


def test_the_record_of_another_run_is_left_alone(tmp_path) -> None:
    """Its people's secrets were told once and are gone: nobody could sign in."""
    (tmp_path / "coaxial.toml").write_text("")
    with pytest.raises(DemoFailed) as failed, open_stage(tmp_path, 0, None, Teller(Console())):
        pass
    assert failed.value.code == "folder_used"
    assert [file.name for file in tmp_path.iterdir()] == ["coaxial.toml"]
