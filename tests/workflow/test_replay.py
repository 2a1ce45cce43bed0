"""A case as stored with every event: written, read back, and the same decisions from it."""

import json
from dataclasses import fields

import pytest

from workflow.case import CaseState, opened
from workflow.case_json import from_json, to_json
from workflow.decisions import Outcome
from workflow.machine import restarted
from workflow.states import LIVE, State
from workflow.triggers import Trigger


def stored(case: CaseState) -> CaseState:
    return from_json(json.loads(json.dumps(to_json(case), allow_nan=False)))


@pytest.mark.parametrize("state", State)
def test_a_case_comes_back_from_its_last_event(walk, state):
    case = walk.to(state).case
    assert stored(case) == case
    assert hash(stored(case)) == hash(case)


@pytest.mark.parametrize("state", State)
def test_a_stored_case_is_made_of_nothing_but_json(walk, state):
    """Names are plain strings, whatever writes them."""
    assert kinds_of(to_json(walk.to(state).case)) <= {dict, list, str, int, float, bool, type(None)}


def kinds_of(value) -> set[type]:
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return {type(value)}.union(*map(kinds_of, inner))


def test_a_whole_number_is_a_number(walk):
    """Some writers of JSON leave a decimal point out."""
    record = to_json(walk.to(State.VERIFIED).case)
    record["verification"]["judged_s"] = 7
    judged_s = from_json(record).verification.judged_s
    assert (judged_s, type(judged_s)) == (7.0, float)


def test_a_replayed_case_decides_as_the_one_that_was_never_stored(new_walk):
    """Every step of a whole procedure twice: once in memory, once written and read before each step."""
    kept, replayed = new_walk(), new_walk()
    for state in (State.SLEEVE_INSERTED,):
        kept.to(state)
    ask = replayed.ask

    def ask_stored(*args, **kwargs):
        replayed.case = stored(replayed.case)
        return ask(*args, **kwargs)

    replayed.ask = ask_stored
    replayed.to(State.SLEEVE_INSERTED)
    assert replayed.case == kept.case


@pytest.mark.parametrize("state", State)
def test_a_restart_voids_the_view_and_all_below_and_keeps_sleeve_and_guide(walk, state):
    before = walk.to(state).case
    decision = restarted(stored(before), 0.0, walk.limits)
    after = decision.after
    if state not in LIVE:
        assert (decision.outcome, after) == (Outcome.LATE, before)
        return
    assert after.state is State.SAFE_HOLD
    assert after.running is None
    assert after.newest_image_id is None
    assert (after.view, after.plan, after.permit, after.motion, after.verification) == (None,) * 5
    assert (after.insertion, after.guide) == (before.insertion, before.guide)


def test_a_sleeve_survives_a_restart(walk):
    walk.to(State.SLEEVE_INSERTED)
    walk.case = restarted(walk.case, 0.0, walk.limits).after
    assert walk.do(Trigger.ACKNOWLEDGED).after.state is State.SLEEVE_INSERTED


@pytest.mark.parametrize("name", [field.name for field in fields(CaseState)])
def test_a_record_without_a_field_is_refused(name):
    data = to_json(opened("case"))
    del data[name]
    with pytest.raises(ValueError, match=name):
        from_json(data)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("state", "sleeping"),
        ("state", 3),
        ("images", "3"),
        ("images", True),
        ("view", "view-1"),
        ("view", {"id": "view-1"}),
        ("case_id", None),
        ("unknown", 1),
    ],
)
def test_a_record_of_another_shape_is_refused(name, value):
    with pytest.raises(ValueError):
        from_json({**to_json(opened("case")), name: value})
