"""Which results of `make mutation` count, and what becomes of a mutant that never ends."""

import os
import time
from functools import partial

import pytest

from benchmarks.mutation import forks, published
from benchmarks.mutation.forks import Outcome, Status, forked
from benchmarks.mutation.mutants import mutants_of
from benchmarks.mutation.published import Result

_MODULE = "workflow.findings"


@pytest.fixture(scope="module")
def mutants():
    return mutants_of(_MODULE)


def _found(mutants):
    """One of each outcome, the last of other tests, the rest not tried."""
    statuses = [Status.KILLED, Status.ENDLESS, Status.STILLBORN, Status.SURVIVED, Status.UNREACHED]
    found = {mutant.key: Result(status, "tests") for mutant, status in zip(mutants, statuses, strict=False)}
    return found | {mutants[5].key: Result(Status.SURVIVED, "other")}


def test_results_are_read_as_they_were_published(mutants, tmp_path):
    file, found = tmp_path / "mutation.json", _found(mutants)
    published.write(file, {"rules": published.lines(found, mutants, "tests"), "none": {}})
    packages = published.read(file)
    assert list(packages) == ["rules"]
    read = published.results(packages["rules"], mutants)
    assert read == found | {mutants[5].key: Result(Status.SURVIVED, "")}
    assert packages["rules"][_MODULE]["outcomes"].startswith("kebsuo..")


def test_what_survived_is_tried_again_with_other_tests_and_what_was_found_is_not(mutants):
    read = published.results(published.lines(_found(mutants), mutants, "tests"), mutants)
    settled = [read[mutant.key].is_settled("tests") for mutant in mutants[:6]]
    assert settled == [True, True, True, True, True, False]
    assert [read[mutant.key].is_settled("newer") for mutant in mutants[:6]] == [True, True, True, False, False, False]


def test_results_of_another_text_of_the_module_or_of_other_mutants_count_for_nothing(mutants, monkeypatch):
    lines = published.lines(_found(mutants), mutants, "tests")
    assert published.results(lines, mutants[:-1]) == {}
    monkeypatch.setattr(published, "digest_of_module", lambda _: "another")
    assert published.results(lines, mutants) == {}


def _looking(each_s):
    """Neither asleep for long nor at work."""
    while True:
        time.sleep(each_s)


@pytest.mark.parametrize(("each_s", "elapsed", "asleep_s"), [(0.0001, 2, 100.0), (0.1, 100, 1.0)])
def test_what_looks_again_and_again_is_endless_soon_and_what_works_a_little_when_its_time_is_over(
    monkeypatch, each_s, elapsed, asleep_s
):
    monkeypatch.setattr(forks, "_ELAPSED", elapsed)
    monkeypatch.setattr(forks, "_ASLEEP_S", asleep_s)
    assert forked(partial(_looking, each_s), processor_s=1).status is Status.ENDLESS


def test_a_run_that_is_broken_off_leaves_no_mutant_behind(tmp_path, monkeypatch):
    def tell_and_sleep():
        (tmp_path / "process").write_text(str(os.getpid()))
        return _looking(0.01)

    def interrupt(*_):
        while not (tmp_path / "process").exists() or not (tmp_path / "process").read_text():
            time.sleep(0.01)
        raise KeyboardInterrupt

    monkeypatch.setattr(forks.select, "select", interrupt)
    with pytest.raises(KeyboardInterrupt):
        forked(tell_and_sleep)
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "process").read_text()), 0)


def test_what_ends_in_time_is_told(monkeypatch):
    monkeypatch.setattr(forks, "_ELAPSED", 20)
    assert forked(lambda: Outcome(Status.KILLED, "a test"), processor_s=1) == Outcome(Status.KILLED, "a test")
