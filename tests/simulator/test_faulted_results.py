"""What `make faulted` counts as wrong, and what its page tells of the published results."""

from dataclasses import replace

import pytest

from benchmarks.evidence.published import State, gathered
from benchmarks.faulted import trials
from benchmarks.faulted.page import page
from benchmarks.faulted.trials import ITEMS, REGISTERED
from simulator.carm.faulted import Fault


def _trial(fault, tmp_path):
    (trial,) = ITEMS[fault].trials(tmp_path, [1_000_000])
    return trial


def test_a_registered_scene_is_wrong_by_its_aim_alone(tmp_path, monkeypatch):
    trial = _trial(Fault.NOTHING, tmp_path)
    assert (trial["number"], trial["kind"], trial["bad"]) == (1_000_000, REGISTERED, False)
    monkeypatch.setattr(trials, "WRONG_MM", trial["measured"]["mm"] / 2.0)
    assert _trial(Fault.NOTHING, tmp_path)["bad"]


def test_a_refused_scene_is_told_by_its_code(tmp_path):
    trial = _trial(Fault.LINE_HIDDEN, tmp_path)
    assert (trial["kind"], trial["bad"]) == ("line_missing", False)


def _made(number, *, bad=False, mm=0.1):
    measured = {"deg": 0.01, "mm": mm}
    trial = {"number": number, "kind": REGISTERED, "bad": bad, "group": "steep", "measured": measured}
    return trial | {"seconds": 2.0, "code": "today", "commit": "abc"}


@pytest.fixture
def states():
    found = {fault: (State("today"),) for fault in ITEMS}
    found[Fault.NOTHING] = gathered([], "today", [_made(7), _made(8, mm=0.3), _made(10)])
    refused = State("today", numbers=((7, 7),), kinds={"guide_mismatch": 1}, others_s=(1, 2.0))
    return found | {Fault.BEAD_Y: (replace(refused, code="earlier"), refused)}


def test_the_page_tells_counts_bounds_seeds_and_the_worst_of_each_fault(states):
    text = page(states)
    assert "4 of 100,000 scenes" in text
    assert "Wrong: 0, at most 60.2 %" in text  # 1 - 0.025^(1/4)
    assert "nothing is wrong: 3 of 3, 29.2 to 100.0 %" in text
    assert "27.8 h of two cores for all" in text  # 100,000 times 2 s on two
    assert "| nothing | 3 | 0 | 70.8 % | 3 | 29.2 to 100.0 % | 0.010 deg, 0.300 mm | 7 to 8, 10 to 10 |  |" in text
    assert "| bead y | 1 | 0 | 97.5 % | 0 | 0.0 to 97.5 % |  | 7 to 7 | guide_mismatch 1 |" in text
    assert "| `earlier` |  | 1 | 0 | 0 of 0, 0.0 to 100.0 % |" in text


def test_the_page_names_each_wrong_acceptance(states):
    text = page(states | {Fault.MIRRORED: gathered([], "today", [_made(9, bad=True, mm=3.0)])})
    assert "- Wrong: `mirrored:9` (steep), 0.010 deg, 3.000 mm." in text
    assert "Wrong: 1, at most" in text
