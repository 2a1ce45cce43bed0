"""H30, whole: under another program, other settings or other device bytes only stop, retreat, statements and the end.

What leads there stays too: control, a pause, its acknowledgement, the end of an attempt, and words.
"""

from dataclasses import replace

import pytest

from workflow.plans import PlanKind
from workflow.refusals import Refusal
from workflow.snapshot import Reading
from workflow.states import IDLE, OVER, State
from workflow.triggers import REQUESTS, Kind, Trigger

_LEFT = frozenset(
    {
        Trigger.STOP,
        Trigger.HOLD_REQUESTED,
        Trigger.ACKNOWLEDGED,
        Trigger.LEASE_TAKEN,
        Trigger.TARGET_DONE,
        Trigger.CASE_CLOSED,
        Trigger.NOTE,
        Trigger.LABEL,
        Trigger.READ,
        Trigger.EXPORT,
    }
)
_MOVES = (Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED)
_KINDS = [kind for kind in PlanKind if kind is not PlanKind.RETREAT]


def _changed(walk) -> None:
    walk.snapshot = replace(walk.snapshot, configuration=Reading("another", 0.01))


def _asked_here(walk, trigger, **changes):
    """What is answered, the case as it was before and after."""
    before = walk.case
    answer = walk.ask(trigger, **changes)
    walk.case = before
    return answer


@pytest.mark.parametrize("state", State)
def test_of_all_requests_only_those_that_end_a_case_are_taken(walk, state) -> None:
    walk.to(state)
    before = {trigger: _asked_here(walk, trigger) for trigger in REQUESTS}
    _changed(walk)
    for trigger in REQUESTS:
        after = _asked_here(walk, trigger)
        if trigger in _LEFT:
            assert type(after) is type(before[trigger]), trigger
        else:
            assert isinstance(after, Refusal), trigger
            if not isinstance(before[trigger], Refusal):
                assert "configuration" in {verdict.code for verdict in after.failed}, trigger


@pytest.mark.parametrize("state", State)
def test_every_fact_and_observation_is_taken(walk, state) -> None:
    walk.to(state)
    _changed(walk)
    for trigger in (one for one in Trigger if one.kind is not Kind.REQUEST):
        assert not isinstance(_asked_here(walk, trigger), Refusal), trigger


@pytest.mark.parametrize("state", sorted(IDLE))
def test_a_retreat_is_planned_approved_and_driven(walk, state) -> None:
    walk.to(state)
    _changed(walk)
    for trigger in _MOVES:
        walk.do(trigger, kind=PlanKind.RETREAT) if trigger is Trigger.PLAN_REQUESTED else walk.do(trigger)
    assert walk.case.state is State.MOVING


@pytest.mark.parametrize("kind", _KINDS)
@pytest.mark.parametrize("state", [one for one in State if one not in OVER])
def test_no_other_motion_is_planned(walk, state, kind) -> None:
    walk.to(state)
    _changed(walk)
    assert isinstance(walk.ask(Trigger.PLAN_REQUESTED, kind=kind), Refusal)


def test_a_motion_that_was_approved_before_the_change_does_not_start(walk) -> None:
    walk.to(State.TARGET_CHOSEN)
    walk.do(Trigger.PLAN_REQUESTED)
    walk.do(Trigger.MOVE_APPROVED)
    _changed(walk)
    refused = walk.refused(Trigger.MOVE_STARTED)
    assert [verdict.hazard for verdict in refused.failed] == ["H30"]
