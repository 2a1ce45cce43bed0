"""A nudge, by which a guide without a bead proves its handedness: what may come while it runs, and when it is over."""

import pytest

from workflow.decisions import ImageUse
from workflow.plans import PlanKind
from workflow.states import State
from workflow.triggers import Trigger

_ENDS = (Trigger.ARRIVED, Trigger.MISSED, Trigger.RELEASED)


@pytest.fixture
def nudging(walk):
    """A case whose first image proved no handedness, the nudge under way; another exposure was asked for before it."""
    walk.to(State.IMAGE_ACQUIRED).do(Trigger.REGISTRATION_REFUSED)
    walk.do(Trigger.EXPOSURE_REQUESTED)
    walk.do(Trigger.PLAN_REQUESTED, kind=PlanKind.NUDGE)
    walk.do(Trigger.MOVE_APPROVED)
    walk.do(Trigger.MOVE_STARTED)
    return walk


@pytest.mark.hazard("H02", "H05")
@pytest.mark.parametrize("end", [None, *_ENDS])
def test_an_image_that_was_asked_for_before_the_nudge_enters_no_chain_during_and_after_it(nudging, end):
    if end is not None:
        nudging.do(end)
    before = nudging.case.state
    assert nudging.do(Trigger.IMAGE_ARRIVED).image_use is ImageUse.UNASSIGNED
    assert (nudging.case.state, nudging.case.image) == (before, None)


@pytest.mark.hazard("H05", "H28")
@pytest.mark.parametrize("end", _ENDS)
def test_a_nudge_that_is_over_leaves_the_view_as_it_was_and_nothing_to_verify(nudging, end):
    view = nudging.case.view
    nudging.do(end)
    assert nudging.case.state is State.CARM_POSITIONED
    assert (nudging.case.view, nudging.case.motion) == (view, None)
    nudging.do(Trigger.EXPOSURE_REQUESTED)
    assert nudging.do(Trigger.IMAGE_ARRIVED).image_use is ImageUse.REGISTRATION
