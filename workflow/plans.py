"""Kinds of motion plans: where each may be asked for and what it is made from."""

from enum import StrEnum

from workflow.links import Link
from workflow.states import IDLE, State


class PlanKind(StrEnum):
    """Why the arm is to move."""

    TARGETING = "targeting"
    CORRECTIVE = "corrective"
    APPROACH = "approach"
    CALIBRATION = "calibration"
    NUDGE = "nudge"
    RETREAT = "retreat"


_V_TO_T = (Link.VIEW, Link.IMAGE, Link.REGISTRATION, Link.TARGET)
_BEFORE_THE_IMAGE = frozenset({State.CASE_OPEN, State.CARM_POSITIONED})

PLAN_STATES: dict[PlanKind, frozenset[State]] = {
    PlanKind.TARGETING: frozenset({State.TARGET_CHOSEN}),
    PlanKind.CORRECTIVE: frozenset({State.TARGET_CHOSEN}),
    PlanKind.APPROACH: _BEFORE_THE_IMAGE,
    PlanKind.CALIBRATION: _BEFORE_THE_IMAGE,
    PlanKind.NUDGE: frozenset({State.CARM_POSITIONED}),
    PlanKind.RETREAT: IDLE,
}

PLAN_INPUTS: dict[PlanKind, tuple[Link, ...]] = {
    PlanKind.TARGETING: _V_TO_T,
    PlanKind.CORRECTIVE: _V_TO_T,
    PlanKind.APPROACH: (),
    PlanKind.CALIBRATION: (),
    PlanKind.NUDGE: (Link.VIEW,),
    PlanKind.RETREAT: (),
}

# Only these bring the guide onto the target, so that the arrival can be verified.
AIMED = frozenset({PlanKind.TARGETING, PlanKind.CORRECTIVE})
