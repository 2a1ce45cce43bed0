"""H03: nothing is aimed with an image so old that nobody knows whether the C-arm still stands."""

import math

import pytest

from tests.workflow.proof import APPROVE, PLAN, START, TARGET
from workflow.plans import PlanKind
from workflow.snapshot import Reading
from workflow.states import State
from workflow.triggers import Trigger


@pytest.mark.hazard("H03")
@pytest.mark.parametrize(
    ("state", "trigger"),
    [
        TARGET,
        PLAN,
        APPROVE,
        START,
        (State.MOVED, Trigger.TARGET_CONFIRMED),
        (State.OFF_TARGET, Trigger.CORRECTION_REQUESTED),
    ],
)
def test_nothing_is_aimed_with_an_old_image(new_walk, state, trigger):
    """H03: half an hour after the exposure nobody knows whether the C-arm still stands."""
    walk = new_walk().to(state)
    walk.spoil(image_exposed=Reading(True, 1801.0))
    refusal = walk.refused(trigger)
    assert [(one.code, one.hazard, one.measured, one.limit) for one in refusal.failed] == [
        ("image_age", "H03", 1801.0, 1800.0)
    ]


def test_an_old_image_does_not_keep_the_arm_from_retreating(new_walk):
    walk = new_walk().to(State.TARGET_CHOSEN)
    walk.spoil(image_exposed=Reading(None, math.inf))
    walk.do(Trigger.PLAN_REQUESTED, kind=PlanKind.RETREAT)
    walk.do(Trigger.MOVE_APPROVED)
    walk.do(Trigger.MOVE_STARTED)
    assert walk.case.state is State.MOVING
