"""Which results of `make evidence` count, kept or published: those of the code that is there, and of no other."""

from dataclasses import replace

import pytest

from benchmarks.evidence.__main__ import PUBLISHED
from benchmarks.evidence.code import fingerprint, imported
from benchmarks.evidence.item import Item
from benchmarks.evidence.items import ITEMS
from benchmarks.evidence.page import page
from benchmarks.evidence.published import State, read, write
from benchmarks.evidence.runs import publish, row, states_of
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


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ('"""Why."""\nwhat = 1  # one\n', True),
        ("what = (\n    1\n)\n", True),
        ('"""Why."""\nwhat = "1"', False),
        ("what = 1\n'what'", False),  # the last expression of a module is no docstring
        ("def what():\n    'one'", False),
    ],
)
def test_words_for_people_and_layout_are_no_code(tree, text, same):
    before = _fingerprint(tree)
    (tree / "package" / "far.py").write_text(text)
    assert (_fingerprint(tree) == before) == same


def test_what_the_trials_do_not_run_may_change(tree):
    before = _fingerprint(tree)
    (tree / "package" / "other.py").write_text("what = 2")
    (tree / "devices" / "readme.md").write_text("other")
    assert _fingerprint(tree) == before


def _keep(folder, *numbers, code=_ITEM.code, **others):
    for number in numbers:
        trial = {"number": number, "kind": "tried", "bad": False, "seconds": 72.0, "code": code, "commit": "abc"}
        keep_line(folder / "one.jsonl", trial | others)


def _today(folder, published):
    return states_of(_ITEM, folder, published)[-1]


@pytest.fixture
def published(tmp_path):
    return tmp_path / "evidence.json"


def _elsewhere(folder):
    """A folder of another machine, with nothing in it."""
    (folder / "elsewhere").mkdir()
    return folder / "elsewhere"


def test_a_result_of_other_code_is_told_apart_and_a_trial_done_twice_counts_once(tmp_path, published):
    write(published, {"one": [State("earlier", ("abc",), ((0, 1),), {"tried": 2}, ({"number": 0, "bad": 2},))]})
    _keep(tmp_path, 0, 1, code="earlier")
    _keep(tmp_path, 0, 0, 2)
    found = row(_ITEM, tmp_path, publish([_ITEM], tmp_path, published)["one"])
    today, (earlier,) = found.today, found.earlier
    assert (today.code, today.done, found.planned, today.bad, found.holds) == (_ITEM.code, 2, 3, 0, False)
    assert (earlier.code, earlier.done, earlier.bad) == ("earlier", 2, 2)
    text = page([found])
    assert f"| 2 | 3 | 0 | 84.2 % | not all run | 0.03 | `{_ITEM.code}` |" in text
    assert "| something | `earlier` | abc | 2 | 2 |" in text


def test_what_is_published_counts_where_nothing_is_kept_and_once_where_it_is(tmp_path, published):
    _keep(tmp_path, 0, 1, 5)
    _keep(tmp_path, 3, bad=True, said="lost")
    publish([_ITEM], tmp_path, published)
    before = published.read_text()
    elsewhere = _elsewhere(tmp_path)
    assert publish([_ITEM], tmp_path, published) == publish([_ITEM], elsewhere, published)
    assert published.read_text() == before
    there = _today(elsewhere, published)
    assert there.known == {0, 1, 3, 5}
    assert (there.done, there.bad, there.others_s, there.commits) == (4, 1, (4, 288.0), ("abc",))
    assert [(trial["number"], trial["said"]) for trial in there.bad_trials] == [(3, "lost")]
    _keep(elsewhere, 1, 2)
    assert publish([_ITEM], elsewhere, published)["one"][-1].numbers == ((0, 3), (5, 5))
    assert _today(tmp_path, published).done == 5


def test_executions_of_one_trial_are_counted_by_kind_behind_those_that_are_published(tmp_path, published):
    for number in range(2):
        _keep(tmp_path, number, kinds={"taken": 3, "hung": 1}, bad=1, first=number == 0)
        publish([_ITEM], tmp_path, published)
    state = _today(_elsewhere(tmp_path), published)
    assert (state.kinds, state.bad, state.first_s, state.others_s) == (
        {"hung": 2, "taken": 6},
        2,
        (1, 72.0),
        (1, 72.0),
    )


def test_of_a_trial_done_twice_the_bad_one_counts(tmp_path, published):
    _keep(tmp_path, 0, bad=True)
    _keep(tmp_path, 0)
    assert _today(tmp_path, published).bad == 1


def test_of_earlier_states_three_are_told_the_bad_and_the_long_runs(tmp_path, published):
    of_trials = {"long": 9, "short": 1, _ITEM.code: 1, "bad": 2, "longer": 10, "tried": 3}
    states = [State(code, kinds={"tried": done}) for code, done in of_trials.items()]
    states[3] = replace(states[3], bad_trials=({"number": 1, "bad": True},))
    write(published, {"one": states, "gone": states})
    publish([_ITEM], tmp_path, published)
    found = read(published)
    assert list(found) == ["one"]
    assert [state.code for state in found["one"]] == ["long", "bad", "longer", _ITEM.code]


def test_every_published_result_is_of_an_item_and_read_as_it_was_written(published):
    items = read(PUBLISHED)
    write(published, items)
    assert published.read_text() == PUBLISHED.read_text()
    assert set(items) <= {item.name for item in ITEMS}


def test_the_hours_of_a_row_reckon_what_a_part_begins_with_once_a_part():
    item, known = replace(_ITEM, at_once=10), State("any", others_s=(4, 288.0))
    assert timing(item, replace(known, first_s=(1, 600.0)), 100).hours == pytest.approx(
        (10 * 600.0 + 90 * 72.0) / 7200.0
    )
    assert timing(item, known, 100).hours == pytest.approx(1.0)  # nobody noted the first
    assert timing(item, State("any"), 100) is None


def test_a_row_that_waits_tells_the_load_that_it_was_timed_under(tmp_path):
    states = [State(_ITEM.code, kinds={"tried": 1}, others_s=(1, 2400.0), load=(1, 6.6))]
    assert "| 1.00 |" in page([row(_ITEM, tmp_path, states)])
    assert "| 1.00, load 7 |" in page([row(replace(_ITEM, waits=True), tmp_path, states)])


def test_every_row_says_of_which_code_it_is():
    alike = {item.code for item in ITEMS if item.name in ("power_loss", "tampering", "failing_writes")}
    assert len(alike) == 1
    of_images, of_frames = (
        next(item for item in ITEMS if item.name == name) for name in ("fuzz_dicom", "fuzz_controller")
    )
    assert of_images.code != of_frames.code
