"""The whole service against an independent model of a case, step by step; `make evidence` plays 20,000 sequences."""

from collections.abc import Iterator

import pytest

from benchmarks.states.model import Model
from benchmarks.states.room import Room, scripted_room
from benchmarks.states.sequences import STEPS, played

_SEEDS = (10, 28, 102)  # a program runs while a sleeve is in; a statement that does not hold the case stops a motion


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Room]:
    with scripted_room(tmp_path_factory.mktemp("room")) as room:
        yield room


@pytest.mark.hazard("H13", "H22", "H35")
def test_random_sequences_do_what_the_model_does(room):
    trials = list(played(room, _SEEDS))
    assert [trial for trial in trials if trial["bad"]] == []
    assert [trial["steps"] for trial in trials] == [STEPS] * len(_SEEDS)


def test_a_difference_is_told_with_the_steps_that_lead_to_it(room, monkeypatch):
    monkeypatch.setattr(Model, "stays", lambda model, trigger: model.goes(trigger, "verified"))
    (trial,) = played(room, _SEEDS[:1])
    assert trial["bad"]
    assert "'verified')" in trial["said"]
    assert 0 < len(trial["prefix"]) < STEPS
