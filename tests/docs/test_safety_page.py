"""The trace from hazard to test is whole, and the page shows it as it is."""

from pathlib import Path

import pytest

from tests.docs import safety_page
from tests.docs.safety_page import gaps, marked_tests, page
from workflow.hazards import HAZARDS

_PAGE = Path(__file__).parents[2] / "docs" / "safety.md"


def test_every_hazard_is_enforced_and_injected_and_every_interlock_proved():
    assert gaps() == []


def test_the_committed_page_is_generated_from_the_code():
    assert _PAGE.read_text() == page(), "run `make docs`"


def test_the_hazards_are_numbered_without_a_gap():
    assert list(HAZARDS) == [f"H{number:02}" for number in range(1, 37)]


@pytest.mark.parametrize(
    ("table", "lost", "said"),
    [
        ("HAZARDS", "H12", "H12 is named and not listed"),
        ("PROOFS", "at_rest", "the interlock at_rest has no case that it refuses"),
    ],
)
def test_what_is_taken_out_is_a_gap(monkeypatch, table, lost, said):
    whole = getattr(safety_page, table)
    monkeypatch.setattr(safety_page, table, {code: one for code, one in whole.items() if code != lost})
    assert said in gaps()


def test_a_hazard_that_nothing_names_is_two_gaps(monkeypatch):
    monkeypatch.setattr(safety_page, "HAZARDS", HAZARDS | {"H99": HAZARDS["H36"]})
    assert gaps() == ["H99 is enforced nowhere", "H99 has no test that injects it"]


def test_a_mark_with_several_hazards_counts_for_each():
    matrix = "tests/robot/test_fault_matrix.py::test_fault"
    assert all(matrix in marked_tests()[code] for code in ("H12", "H18", "H21"))
