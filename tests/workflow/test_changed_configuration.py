"""H30: under another program, settings or device bytes all is recorded, and no motion is left but the retreat."""

from dataclasses import replace

import pytest

from workflow.plans import PLAN_STATES, PlanKind
from workflow.refusals import Refusal
from workflow.snapshot import Reading
from workflow.states import IDLE, State
from workflow.triggers import Kind, Trigger

_MOVES = (Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED)
_OTHERS = [kind for kind in PlanKind if kind is not PlanKind.RETREAT]


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
