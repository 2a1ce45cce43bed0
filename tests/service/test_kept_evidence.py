"""Which kept results of `make evidence` count: those of the code that is there, and of no other."""

from dataclasses import replace

import pytest

from benchmarks.evidence.code import fingerprint, imported
from benchmarks.evidence.item import Item
from benchmarks.evidence.items import ITEMS
from benchmarks.evidence.page import page
from benchmarks.evidence.runs import row
from benchmarks.evidence.timing import timing
from benchmarks.kept import keep_line

_ITEM = Item("one", "something", "0 bad", lambda _: 3, lambda *_: iter(()), 1, modules=("benchmarks.kept",))


@pytest.fixture
def tree(tmp_path):
    for name, text in {
        "requirements.lock": "library==1",
        "package/__init__.py": "",
        "package/begin.py": "import os\nfrom package import near",
        "package/near.py": "def later():\n    from package.far import what",
        "package/far.py": "what = 1",
        "package/other.py": "import package.begin",
        "devices/room.toml": "name = 1",
    }.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def _fingerprint(tree):
    return fingerprint(["package.begin"], ["devices/*.toml"], tree)


def test_what_a_module_comes_to_by_imports_is_followed_into_functions_and_no_further(tree):
    found = {file.name for file in imported(["package.begin"], tree)}
    assert found == {"__init__.py", "begin.py", "near.py", "far.py"}


@pytest.mark.parametrize("changed", ["package/far.py", "devices/room.toml", "requirements.lock", "package/__init__.py"])
def test_code_that_changed_is_another_one(tree, changed):
    before = _fingerprint(tree)
    (tree / changed).write_text("what = 2")
    assert _fingerprint(tree) != before


def test_what_the_trials_do_not_run_may_change(tree):
    before = _fingerprint(tree)
    (tree / "package" / "other.py").write_text("what = 2")
    (tree / "devices" / "readme.md").write_text("other")
    assert _fingerprint(tree) == before


def test_a_result_of_other_code_is_told_apart_and_a_trial_done_twice_counts_once(tmp_path):
    for number, code in ((0, "earlier"), (1, "earlier"), (0, _ITEM.code), (0, _ITEM.code), (2, _ITEM.code)):
        trial = {"number": number, "kind": "tried", "bad": code == "earlier", "seconds": 72.0}
        keep_line(tmp_path / "one.jsonl", trial | {"code": code, "commit": "abc"})
    found = row(_ITEM, tmp_path)
    today, (earlier,) = found.today, found.earlier
    assert (today.code, today.done, today.planned, today.bad, today.holds) == (_ITEM.code, 2, 3, 0, False)
    assert (earlier.code, earlier.done, earlier.bad) == ("earlier", 2, 2)
    text = page([found])
    assert f"| 2 | 3 | 0 | 84.2 % | not all run | 0.03 | `{_ITEM.code}` |" in text
    assert "| something | `earlier` | abc | 2 | 2 |" in text


def test_the_hours_of_a_row_reckon_what_a_part_begins_with_once_a_part():
    item = replace(_ITEM, at_once=10)
    trials = [{"seconds": 600.0, "first": True}, *[{"seconds": 72.0, "first": False}] * 4]
    assert timing(item, trials, 100).hours == pytest.approx((10 * 600.0 + 90 * 72.0) / 7200.0)
    assert timing(item, trials[1:], 100).hours == pytest.approx(1.0)  # nobody noted the first
    assert timing(item, [], 100) is None


def test_a_row_that_waits_tells_the_load_that_it_was_timed_under(tmp_path):
    trial = {"number": 0, "kind": "tried", "bad": False, "seconds": 2400.0, "first": False, "load": 6.6}
    keep_line(tmp_path / "one.jsonl", trial | {"code": _ITEM.code, "commit": "abc"})
    assert "| 1.00 |" in page([row(_ITEM, tmp_path)])
    assert "| 1.00, load 7 |" in page([row(replace(_ITEM, waits=True), tmp_path)])


def test_every_row_says_of_which_code_it_is():
    alike = {item.code for item in ITEMS if item.name in ("power_loss", "tampering", "failing_writes")}
    assert len(alike) == 1
    of_images, of_frames = (
        next(item for item in ITEMS if item.name == name) for name in ("fuzz_dicom", "fuzz_controller")
    )
    assert of_images.code != of_frames.code
