"""What a request needs of the chain, and who makes it."""

from workflow.case import CaseState
from workflow.links import Link
from workflow.plans import PLAN_INPUTS, PLAN_STATES, PlanKind
from workflow.settling import AIM
from workflow.triggers import Trigger

# Who makes a link; an image and its verification follow from the exposure that a person asks for.
MAKERS: dict[Link, Trigger] = {
    Link.VIEW: Trigger.CARM_POSITION_CONFIRMED,
    Link.IMAGE: Trigger.EXPOSURE_REQUESTED,
    Link.REGISTRATION: Trigger.REGISTRATION_COMPLETED,
    Link.TARGET: Trigger.TARGET_CONFIRMED,
    Link.PLAN: Trigger.PLAN_REQUESTED,
    Link.PERMIT: Trigger.MOVE_APPROVED,
    Link.MOTION: Trigger.MOVE_STARTED,
    Link.VERIFICATION: Trigger.EXPOSURE_REQUESTED,
}
_NEEDED: dict[Trigger, tuple[Link, ...]] = {
    Trigger.EXPOSURE_REQUESTED: (Link.VIEW,),
    Trigger.NEWEST_IMAGE_REUSED: (Link.VIEW,),
    Trigger.RETAKE: (Link.VIEW, Link.IMAGE),
    Trigger.TARGET_CONFIRMED: (Link.VIEW, Link.IMAGE, Link.REGISTRATION),
    Trigger.TARGET_WITHDRAWN: AIM,
    Trigger.CORRECTION_REQUESTED: tuple(Link),
    Trigger.VERIFICATION_REJECTED: tuple(Link),
    Trigger.INSERTION_STARTED: tuple(Link),
    Trigger.TARGET_DONE: tuple(Link),
}
# A verification stands when the C-arm is turned away, so these ask for nothing above it.
_RELY_ON_VERIFICATION = frozenset({Trigger.VERIFICATION_REJECTED, Trigger.INSERTION_STARTED, Trigger.TARGET_DONE})
_MOVES = {
    Trigger.PLAN_REQUESTED: (),
    Trigger.MOVE_APPROVED: (Link.PLAN,),
    Trigger.MOVE_STARTED: (Link.PLAN, Link.PERMIT),
}
# Rows that are listed, and yet ask for a part of the chain.
GUARDED_BY_CHAIN = frozenset({Trigger.TARGET_CONFIRMED, Trigger.CORRECTION_REQUESTED, *_MOVES})


def usable_plan(case: CaseState) -> bool:
    """The case has a plan that no motion was started from, of a kind that may be used in this state."""
    return case.plan is not None and not case.plan.used and case.state in PLAN_STATES[case.plan.kind]


def _is_there(case: CaseState, link: Link) -> bool:
    if link is Link.PLAN:
        return usable_plan(case) or case.motion is not None
    if link is Link.PERMIT:
        return case.permit is not None or case.motion is not None
    return case.link(link) is not None


def first_missing(case: CaseState, trigger: Trigger, kind: PlanKind | None) -> Link | None:
    """The first link that a request needs and the case has not, in the order of the chain."""
    if trigger in _MOVES:
        inputs = PLAN_INPUTS[kind] if kind else ()
        own = (link for link in _MOVES[trigger] if not (usable_plan(case) if link is Link.PLAN else case.permit))
        return next((link for link in inputs if case.link(link) is None), next(own, None))
    if trigger in _RELY_ON_VERIFICATION and case.verification is not None:
        return None
    return next((link for link in _NEEDED.get(trigger, ()) if not _is_there(case, link)), None)
