"""A run of evidence that is asked to end: at once, with nothing left lying about, and what was done is kept."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time

import pytest

from benchmarks.evidence import inputs, runs
from benchmarks.evidence.item import Item
from benchmarks.evidence.published import read
from benchmarks.kept import kept_lines
from tests.waiting import until


def _without_end(folder, numbers):
    """One trial, and a second that takes for ever."""
    yield {"number": numbers[0], "kind": "tried", "bad": False}
    (folder / "left over").touch()
    try:
        time.sleep(3600.0)
    finally:
        (folder / "left over").unlink()


@pytest.mark.parametrize("asked", [signal.SIGTERM, signal.SIGINT])
def test_a_worker_that_is_asked_to_end_clears_away_and_takes_no_other_part(tmp_path, asked):
    item = Item("one", "something", "0 bad", lambda _: 3, _without_end, 1, modules=("benchmarks.kept",))

    def work():
        signal.signal(signal.SIGINT, signal.default_int_handler)  # what is started in the background ignores it
        runs._begin()
        for part in range(3):  # as a pool does, to which whatever is raised is the part's result
            try:
                runs._run_part(item, tmp_path, tmp_path, [part])
            except BaseException:  # noqa: BLE001  # as the pool does
                continue

    worker = multiprocessing.get_context("fork").Process(target=work, daemon=True)
    worker.start()
    until((tmp_path / "left over").exists)
    os.kill(worker.pid, asked)
    worker.join(20.0)
    assert worker.exitcode == 1
    assert not (tmp_path / "left over").exists()
    assert [trial["number"] for trial in kept_lines(tmp_path / "one.jsonl")] == [0]


def test_a_run_that_is_asked_to_end_publishes_what_was_done(tmp_path):
    options = ["--folder", tmp_path, "--faults", "line_hidden"]
    run = subprocess.Popen([sys.executable, "-m", "benchmarks.faulted", *options], stderr=subprocess.DEVNULL)
    try:
        until((tmp_path / "line_hidden.jsonl").exists, 60.0)
        run.terminate()
        assert run.wait(20.0) == 1
    finally:
        run.kill()
        run.wait()
    (state,) = read(tmp_path / "published.json")["line_hidden"]
    assert state.known == {trial["number"] for trial in kept_lines(tmp_path / "line_hidden.jsonl")}


def test_of_two_runs_that_prepare_one_folder_the_first_to_be_done_has_made_it(tmp_path):
    def fill(folder):
        (folder / "result").write_text("the second")
        (tmp_path / "data").mkdir()
        (tmp_path / "data" / "result").write_text("the first")

    inputs._make(tmp_path / "data", fill)
    assert (tmp_path / "data" / "result").read_text() == "the first"
    assert [one.name for one in tmp_path.iterdir()] == ["data"]
