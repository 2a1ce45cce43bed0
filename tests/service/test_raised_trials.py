"""A trial of the evidence that raises is a bad one, and the numbers behind it are run; where nothing runs, none is."""

import json
from dataclasses import replace

import pytest

from benchmarks.evidence import power_loss, runs
from benchmarks.evidence.disk import Disk
from benchmarks.evidence.item import Item
from benchmarks.evidence.page import page
from benchmarks.evidence.published import read
from benchmarks.evidence.raised import TrialError, trial_of
from benchmarks.faulted.page import page as page_of_faulted
from benchmarks.faulted.trials import ITEMS as FAULTED
from benchmarks.kept import kept_lines
from simulator.carm.faulted import Fault


class _Raising:
    """Trials of which some raise, and which know how often they were begun."""

    def __init__(self, *raising):
        self.raising, self.begun = set(raising), []

    def __call__(self, _inputs, numbers):
        self.begun.append(tuple(numbers))
        for number in numbers:
            if number in self.raising:
                raise ZeroDivisionError("the name of a patient")
            yield {"number": number, "kind": "tried", "bad": False}

    def item(self, **others):
        return Item("one", "something", "0 bad", lambda _: 3, self, 1, modules=("benchmarks.kept",), **others)


def _ran(folder, item, numbers):
    runs._run_part(item, folder, folder, numbers)


def _kept(folder):
    return {trial["number"]: trial["bad"] for trial in kept_lines(folder / "one.jsonl")}


def test_a_trial_that_raises_is_kept_as_a_bad_one_and_the_others_of_its_part_are_run(tmp_path):
    trials = _Raising(1, 2)
    _ran(tmp_path, trials.item(), range(5))
    assert _kept(tmp_path) == {0: False, 1: True, 2: True, 3: False, 4: False}
    assert trials.begun == [(0, 1, 2, 3, 4), (2, 3, 4), (3, 4)]


def test_what_is_kept_names_the_error_and_its_place_and_none_of_its_words(tmp_path):
    _ran(tmp_path, _Raising(0).item(), range(2))
    text = (tmp_path / "one.jsonl").read_text()
    (raised,) = (trial for trial in kept_lines(tmp_path / "one.jsonl") if trial["bad"])
    assert raised["error"] == "builtins.ZeroDivisionError"
    assert raised["place"].startswith("tests/service/test_raised_trials.py:")
    assert raised["place"].endswith(" in __call__")
    assert "patient" not in text


def test_the_pages_tell_of_it(tmp_path):
    item, published = _Raising(1).item(executions=10), tmp_path / "evidence.json"
    _ran(tmp_path, item, range(2))
    states = runs.publish([item], tmp_path, published)["one"]
    assert read(published)["one"][-1].raised == states[-1].raised
    text = page([runs.row(item, tmp_path, states)])
    assert "- **one** 1: builtins.ZeroDivisionError, tests/service/test_raised_trials.py:" in text
    assert "raised 10, tried 1." in text  # all of its executions
    assert "| 11 | 30 | 10 |" in text
    faulted = page_of_faulted(dict.fromkeys(FAULTED, states) | {Fault.MIRRORED: states})
    assert "- Raised, counted as wrong: `mirrored:1`, builtins.ZeroDivisionError, tests/service/" in faulted


def test_a_number_that_raised_is_done_and_not_run_again(tmp_path):
    item = _Raising(1).item()
    _ran(tmp_path, item, range(2))
    assert runs.left(item, tmp_path, tmp_path / "evidence.json", range(4)) == [[2], [3]]


@pytest.mark.parametrize("numbers", [range(1), range(50)])
def test_where_nothing_can_be_tried_the_part_fails_and_no_number_is_done(tmp_path, numbers):
    trials = _Raising(*range(50))
    with pytest.raises(ZeroDivisionError):
        _ran(tmp_path, trials.item(), numbers)
    assert _kept(tmp_path) == {}
    assert len(trials.begun) <= 3


def test_where_nothing_can_be_tried_any_more_the_part_fails_and_what_raised_is_not_done(tmp_path):
    """As behind the end of a server: the one that was done before raises now as well."""
    trials = _Raising(*range(2, 50))
    _ran(tmp_path, trials.item(), range(2))
    trials.raising |= {0, 1}
    with pytest.raises(ZeroDivisionError):
        _ran(tmp_path, trials.item(), range(2, 50))
    assert _kept(tmp_path) == {0: False, 1: False}


def test_where_others_can_be_done_every_one_that_raises_is_bad_however_many(tmp_path):
    trials = _Raising(*range(1, 10))
    _ran(tmp_path, trials.item(), range(10))
    assert _kept(tmp_path) == {0: False} | dict.fromkeys(range(1, 10), 1)
    assert trials.begun.count((0,)) == 3  # tried again behind three that raised


def test_a_result_of_other_code_does_not_say_that_others_can_be_done(tmp_path):
    (tmp_path / "one.jsonl").write_text(json.dumps({"number": 7, "bad": False, "code": "earlier"}) + "\n")
    with pytest.raises(ZeroDivisionError):
        _ran(tmp_path, _Raising(0).item(), [0])
    assert len(kept_lines(tmp_path / "one.jsonl")) == 1


def test_what_raises_behind_the_last_trial_fails_the_part(tmp_path):
    def trials(_inputs, numbers):
        yield from ({"number": number, "kind": "tried", "bad": False} for number in numbers)
        raise RuntimeError("a process is left over")

    item = replace(_Raising().item(), trials=trials)
    with pytest.raises(RuntimeError, match="left over"):
        _ran(tmp_path, item, range(2))
    assert _kept(tmp_path) == {0: False, 1: False}


def test_of_trials_in_another_order_the_one_that_raised_is_bad(tmp_path):
    def backwards(_inputs, numbers):
        for number in sorted(numbers, reverse=True):
            with trial_of(number):
                yield {"number": number, "kind": "tried", "bad": 1 // (number - 2) > 1}

    _ran(tmp_path, replace(_Raising().item(), trials=backwards), range(5))
    assert _kept(tmp_path) == {0: False, 1: False, 2: True, 3: False, 4: False}


def test_a_power_cut_that_raises_says_its_number(tmp_path, monkeypatch):
    """They come in the order of their moments, not of their numbers."""
    monkeypatch.setattr(power_loss, "_entries", lambda _: 0)
    monkeypatch.setattr(Disk, "cut", lambda *_: 1 / 0)
    with pytest.raises(TrialError) as raised:
        list(power_loss.cuts(tmp_path, [power_loss.Call("write", "a")] * 1000, range(20), tmp_path / "cut"))
    first = min(range(20), key=lambda seed: power_loss.Random(seed).randrange(1000))
    assert raised.value.number == first != 0
    assert isinstance(raised.value.__cause__, ZeroDivisionError)
