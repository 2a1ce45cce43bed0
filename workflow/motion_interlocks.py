"""Interlocks of a plan, of its approval, of the permit and of what is in the guide that is to move."""

from workflow.case import CaseState
from workflow.checks import Interlock, bounded, given, id_of, joints_near, same, since, yes
from workflow.facts import Acknowledged, Approval, InsertionStarted, MoveApproved, MoveStarted, PlanRequested
from workflow.findings import Finding, fresh, is_true, within
from workflow.inquiry import Inquiry
from workflow.plans import PLAN_INPUTS, PlanKind
from workflow.states import GuideState
from workflow.triggers import Trigger

_PLAN = (Trigger.PLAN_REQUESTED,)
_APPROVE = (Trigger.MOVE_APPROVED,)


def input_ids(case: CaseState, kind: PlanKind) -> tuple[str | None, ...]:
    """Ids of what a plan of this kind is made from, None where void."""
    return tuple(id_of(case.link(link)) for link in PLAN_INPUTS[kind])


def _joined(ids: tuple[str | None, ...]) -> str:
    return ", ".join(id_ or "void" for id_ in ids)


def _plan_plausible(inquiry: Inquiry) -> Finding:
    """Joints are where a UR5 can have them."""
    plan, limits = inquiry.given(PlanRequested), inquiry.limits
    if plan is None:
        return is_true(None)
    findings = tuple(within(abs(joint), limits.joint_rad, "rad") for joint in plan.start_joints_rad)
    return next((finding for finding in findings if not finding.passed), is_true(True))


def _guide_empty(inquiry: Inquiry) -> Finding:
    """Empty; or a wire is left in, and the plan retreats along it."""
    guide, plan = inquiry.case.guide, inquiry.plan
    along_wire = plan is not None and plan.kind is PlanKind.RETREAT and plan.axial
    passed = guide is GuideState.EMPTY or (guide is GuideState.WIRE and along_wire)
    return Finding(passed, guide, "empty, or wire and an axial retreat")


def _guide_known(inquiry: Inquiry) -> Finding:
    guide = inquiry.case.guide
    return Finding(guide is not GuideState.UNKNOWN, guide, "stated")


def _no_insertion(inquiry: Inquiry) -> Finding:
    insertion = inquiry.case.insertion
    return Finding(insertion is None, insertion.status if insertion else "none", "none")


def _approval(inquiry: Inquiry) -> Approval | None:
    facts = inquiry.given(MoveApproved) or inquiry.given(InsertionStarted)
    return facts.approval if facts else None


def _token(inquiry: Inquiry) -> int | None:
    source = _approval(inquiry) or inquiry.given(MoveStarted)
    return source.control_token if source else None


def _bound_ids(inquiry: Inquiry) -> str | None:
    return _joined(inquiry.case.permit.made_from) if inquiry.case.permit else None


def _plan_ids(inquiry: Inquiry) -> str | None:
    plan = inquiry.case.plan
    return _joined((plan.id, *input_ids(inquiry.case, plan.kind))) if plan else None


def _devices_hash(inquiry: Inquiry) -> str | None:
    return fresh(inquiry.snapshot.devices_hash, inquiry.limits.record_age_s)


def _permit_unused(inquiry: Inquiry) -> Finding:
    used, asked = inquiry.case.used_permit_id, inquiry.given(MoveStarted)
    return Finding(asked is not None and asked.permit_id != used, used, "another")


PLAN_PLAUSIBLE = Interlock("plan_plausible", "H09", "a figure of the plan is out of range", _plan_plausible, asks=True)
PLAN_PARENTS = Interlock(
    "plan_parents",
    "H22",
    "the plan was made from what is void or replaced",
    same(
        lambda i: _joined(i.plan.made_from) if i.plan else None,
        lambda i: _joined(input_ids(i.case, i.plan.kind)) if i.plan else None,
    ),
    _PLAN,
    asks=True,
)
AIM_ANGLE = Interlock(
    "aim_angle",
    "H07",
    "the direction predicted at the target is not sure enough",
    bounded(
        lambda i: i.plan.predicted_angle_rad if i.plan else None,
        lambda limits: min(limits.aim_angle_rad, limits.angle_error_rad),
        "rad",
    ),
    (Trigger.RETAKE,),
    hard=lambda limits: limits.angle_error_rad,
)
AIM_POSITION = Interlock(
    "aim_position",
    "H07",
    "the position predicted at the target is not sure enough",
    bounded(
        lambda i: i.plan.predicted_position_mm if i.plan else None,
        lambda limits: min(limits.aim_position_mm, limits.position_error_mm),
        "mm",
    ),
    (Trigger.RETAKE,),
    hard=lambda limits: limits.position_error_mm,
)
PLAN_CURRENT = Interlock(
    "plan_current",
    "H22",
    "not the newest plan",
    same(given(MoveApproved, lambda m: m.plan_id), lambda i: id_of(i.case.plan)),
    _PLAN,
    asks=True,
)
SURGEON = Interlock(
    "surgeon",
    "H13",
    "only a surgeon may approve this",
    yes(lambda i: a.surgeon if (a := _approval(i)) else None),
    asks=True,
)
PIN = Interlock(
    "pin",
    "H13",
    "the PIN was not given with this request",
    yes(lambda i: a.pin_confirmed if (a := _approval(i)) else None),
    asks=True,
)
LEASE = Interlock(
    "lease",
    "H15",
    "somebody else has control",
    same(_token, lambda i: fresh(i.snapshot.control_token, i.limits.record_age_s)),
    (Trigger.LEASE_TAKEN,),
    asks=True,
)
DEVICES_KNOWN = Interlock(
    "devices_known", "H10", "the device files are unknown", lambda i: is_true(_devices_hash(i) is not None)
)
PERMIT_UNUSED = Interlock("permit_unused", "H14", "this permit was used", _permit_unused, _PLAN, asks=True)
PERMIT_CURRENT = Interlock(
    "permit_current",
    "H13",
    "no such permit",
    same(given(MoveStarted, lambda m: m.permit_id), lambda i: id_of(i.case.permit)),
    _APPROVE,
    asks=True,
)
PERMIT_FRESH = Interlock(
    "permit_fresh",
    "H13",
    "the permit has expired",
    since(lambda i: i.case.permit.issued_s if i.case.permit else None, lambda limits: limits.permit_life_s),
    _APPROVE,
)
PERMIT_HOLDER = Interlock(
    "permit_holder",
    "H15",
    "the permit was given under another control lease",
    same(_token, lambda i: i.case.permit.control_token if i.case.permit else None),
    _APPROVE,
    asks=True,
)
PERMIT_PARENTS = Interlock(
    "permit_parents", "H22", "the permit binds what is void or replaced", same(_bound_ids, _plan_ids), _PLAN
)
PERMIT_JOINTS = Interlock(
    "permit_joints",
    "H04",
    "the arm is not where it was when the permit was given",
    joints_near(lambda i: i.case.permit.joints_rad if i.case.permit else None),
    _PLAN,
)
PERMIT_DEVICES = Interlock(
    "permit_devices",
    "H10",
    "a device file was changed after the permit was given",
    same(_devices_hash, lambda i: i.case.permit.devices_hash if i.case.permit else None),
    _APPROVE,
)
PERMIT_GUIDE = Interlock(
    "permit_guide",
    "H35",
    "something else is in the guide than when the permit was given",
    same(lambda i: i.case.guide, lambda i: i.case.permit.guide if i.case.permit else None),
    _APPROVE,
)
GUIDE_EMPTY = Interlock(
    "guide_empty",
    "H35",
    "the guide is not stated to be empty",
    _guide_empty,
    (Trigger.GUIDE_STATE_STATED,),
)
GUIDE_KNOWN = Interlock(
    "guide_known", "H35", "nobody stated what is in the guide", _guide_known, (Trigger.GUIDE_STATE_STATED,)
)
GUIDE_RESTATED = Interlock(
    "guide_restated",
    "H35",
    "the surgeon's statement about the guide is not what the case was told",
    same(given(Acknowledged, lambda a: a.guide), lambda i: i.case.guide),
    (Trigger.GUIDE_STATE_STATED, Trigger.SLEEVE_REMOVED, Trigger.INSERTION_CANCELLED),
    asks=True,
)
NO_INSERTION = Interlock(
    "no_insertion", "H29", "a sleeve is being inserted or in place", _no_insertion, (Trigger.TARGET_DONE,)
)
