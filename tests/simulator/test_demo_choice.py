"""Which pedicles a demonstration goes to, and what it refuses before it starts anything."""

from pathlib import Path

import pytest
from rich.console import Console

from simulator.demo.failure import NothingStartedError
from simulator.demo.stage import open_stage
from simulator.demo.telling import Teller
from simulator.demo.wanted import Wanted, check, chosen

ALL = tuple(f"L{number}-{side}" for number in (1, 2, 3, 4, 5) for side in ("left", "right"))


def wanted(*pedicles: str, faults: tuple[str, ...] = (), stay: bool = False, truth: Path | None = None) -> Wanted:
    return Wanted(pedicles, None, 0, stay, faults, truth)


def refused(asked: Wanted) -> NothingStartedError:
    with pytest.raises(NothingStartedError) as failed:
        check(asked)
    return failed.value


def test_those_that_were_asked_for_in_their_order() -> None:
    assert chosen(ALL, ["L5-left", "L3-left"]) == ("L5-left", "L3-left")
    check(wanted("L5-left", "L3-left", faults=("mirrored", "packets_stop")))


def test_the_usual_ones_and_all_of_a_room_that_has_not_them() -> None:
    assert chosen(ALL, []) == ("L3-left", "L3-right", "L4-left", "L4-right")
    assert chosen(("L3-left", "T12-left"), []) == ("L3-left", "T12-left")


def test_an_unknown_pedicle_is_refused_with_those_there_are() -> None:
    failed = refused(wanted("L3-left", "C7-left"))
    assert failed.code == "pedicle_unknown"
    assert str(failed).count("C7-left") == 1
    assert ", ".join(ALL) in str(failed)


def test_a_pedicle_named_twice_is_refused() -> None:
    failed = refused(wanted("L3-left", "L4-left", "L3-left"))
    assert str(failed) == "pedicle_repeated: L3-left: a case has each target once"


def test_an_unknown_fault_is_refused_with_those_there_are() -> None:
    failed = refused(wanted(faults=("mirrored", "mirored")))
    assert failed.code == "fault_unknown"
    assert str(failed).startswith("fault_unknown: mirored; there are ")
    assert "mirrored" in str(failed)
    assert "packets_stop" in str(failed)


@pytest.mark.parametrize("asked", [wanted("L3-left", stay=True), wanted(faults=("mirrored",), stay=True)])
def test_what_a_room_that_only_stays_would_not_do_is_refused(asked: Wanted) -> None:
    assert refused(asked).code == "nothing_to_place"


def test_a_truth_that_the_room_would_not_take_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "truth.toml"
    assert str(refused(wanted(truth=file))) == f"truth_refused: {file}: No such file or directory"
    file.write_text("seed = -1")
    assert str(refused(wanted(truth=file))) == f"truth_refused: {file}: seed of the truth is no whole number from 0"


def test_the_pedicles_of_a_ct_are_those_planned_in_it(tmp_path: Path) -> None:
    file = tmp_path / "truth.toml"
    file.write_text(
        '[ct]\npath = "scan"\n[ct.pedicles.T12-left]\nentry_mm = [1, 2, 3]\ntarget_mm = [1, 20, 3]\n',
    )
    assert str(refused(wanted(truth=file))) == f"truth_refused: {tmp_path / 'scan'}: No such file or directory"
    (tmp_path / "scan").mkdir()
    check(wanted("T12-left", truth=file))
    assert str(refused(wanted("L3-left", truth=file))) == "pedicle_unknown: L3-left; there are T12-left"


@pytest.mark.parametrize("left", ["coaxial.toml", "service"])
def test_the_record_of_another_run_is_left_alone(tmp_path: Path, left: str) -> None:
    """Its people's secrets were told once and are gone: nobody could sign in."""
    (tmp_path / left).write_text("")
    with pytest.raises(NothingStartedError) as failed, open_stage(tmp_path, 0, None, Teller(Console())):
        pass
    assert failed.value.code == "folder_used"
    assert [file.name for file in tmp_path.iterdir()] == [left]
