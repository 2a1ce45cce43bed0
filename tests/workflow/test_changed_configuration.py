"""H30: under another program, settings or device bytes all is recorded, and no motion is left but the retreat."""

from dataclasses import replace

import pytest

from tests.workflow.proof import failed
from workflow.machine import allowed
from workflow.plans import PLAN_STATES, PlanKind
from workflow.refusals import Refusal
from workflow.snapshot import Reading
from workflow.states import IDLE, State
from workflow.triggers import REQUESTS, Kind, Trigger

_MOVES = (Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED)
_OTHERS = [kind for kind in PlanKind if kind is not PlanKind.RETREAT]

_STILL_ALLOWED = {
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


def _changed(walk) -> None:
    walk.snapshot = replace(walk.snapshot, configuration=Reading("another", 0.01))


@pytest.mark.parametrize("state", State)
def test_every_fact_and_observation_is_taken(walk, state) -> None:
    walk.to(state)
    _changed(walk)
    for trigger in (one for one in Trigger if one.kind is not Kind.REQUEST):
        here = walk.case
        assert not isinstance(walk.ask(trigger), Refusal), trigger
        walk.case = here


@pytest.mark.parametrize("state", sorted(IDLE))
def test_a_retreat_is_planned_approved_and_driven(walk, state) -> None:
    walk.to(state)
    _changed(walk)
    for trigger in _MOVES:
        walk.do(trigger, kind=PlanKind.RETREAT) if trigger is Trigger.PLAN_REQUESTED else walk.do(trigger)
    assert walk.case.state is State.MOVING


@pytest.mark.hazard("H30")
@pytest.mark.parametrize(("kind", "state"), [(kind, state) for kind in _OTHERS for state in sorted(PLAN_STATES[kind])])
def test_no_other_motion_is_planned_where_it_could_be(walk, state, kind) -> None:
    walk.to(state)
    _changed(walk)
    refused = walk.refused(Trigger.PLAN_REQUESTED, kind=kind)
    assert [verdict.hazard for verdict in refused.failed] == ["H30"]


@pytest.mark.hazard("H30")
def test_a_motion_that_was_approved_before_the_change_does_not_start(walk) -> None:
    walk.to(State.TARGET_CHOSEN)
    walk.do(Trigger.PLAN_REQUESTED)
    walk.do(Trigger.MOVE_APPROVED)
    _changed(walk)
    refused = walk.refused(Trigger.MOVE_STARTED)
    assert [verdict.hazard for verdict in refused.failed] == ["H30"]


@pytest.mark.hazard("H30")
@pytest.mark.parametrize("trigger", REQUESTS)
@pytest.mark.parametrize("state", State)
def test_under_another_configuration_a_case_goes_no_further(new_walk, state, trigger):
    """H30: only stop, words and what leads to a retreat or to the end of the case are judged as ever."""
    walk = new_walk().to(state)
    facts = walk.facts(trigger)
    usual = new_walk().to(state).ask(trigger, facts)
    _changed(walk)
    answer = walk.ask(trigger, facts)
    if trigger in _STILL_ALLOWED:
        assert type(answer) is type(usual)
        assert "configuration" not in failed(answer)
    else:
        assert isinstance(answer, Refusal)
        assert "configuration" in failed(answer)


def test_under_another_configuration_the_arm_still_retreats_and_the_case_closes(new_walk):
    walk = new_walk().to(State.VERIFIED)
    _changed(walk)
    walk.do(Trigger.RESTARTED)
    walk.do(Trigger.GUIDE_STATE_STATED)
    walk.do(Trigger.ACKNOWLEDGED)
    for trigger in (Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED):
        walk.do(trigger, kind=PlanKind.RETREAT)
    walk.do(Trigger.ARRIVED)
    refusal = walk.refused(Trigger.PLAN_REQUESTED, kind=PlanKind.APPROACH)
    assert [(one.code, one.hazard, one.measured, one.limit) for one in refusal.failed] == [
        ("configuration", "H30", "another", "configuratio")
    ]
    walk.do(Trigger.CASE_CLOSED)


def test_a_retreat_that_was_planned_lets_nothing_else_past(new_walk):
    walk = new_walk().to(State.REGISTERED)
    walk.do(Trigger.PLAN_REQUESTED, kind=PlanKind.RETREAT)
    _changed(walk)
    assert "configuration" in failed(walk.refused(Trigger.TARGET_CONFIRMED))


def test_the_status_says_that_only_a_plan_may_still_be_asked_for(new_walk):
    """It may be a retreat's; what brings the case further may not."""
    walk = new_walk().to(State.TARGET_CHOSEN)
    _changed(walk)
    offered = allowed(walk.case, walk.snapshot, walk.limits, walk.now_s)
    assert offered[Trigger.PLAN_REQUESTED].allowed
    assert [verdict.code for verdict in offered[Trigger.MOVE_APPROVED].reasons] == ["configuration"]
