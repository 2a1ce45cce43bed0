"""Permits: one approval, one motion."""

from workflow.case import Permit
from workflow.facts import MoveApproved
from workflow.inquiry import Inquiry


def issue(inquiry: Inquiry) -> Permit:
    """A permit for the plan of the case, bound to what the interlocks have just seen.

    Raises
    ------
    ValueError
        If there is no plan or the device files are unknown.
    """
    facts, plan = inquiry.told(MoveApproved), inquiry.case.plan
    devices_hash = inquiry.snapshot.devices_hash.value
    if plan is None or devices_hash is None:
        raise ValueError("a permit binds a plan and the device files")
    return Permit(
        id=facts.permit_id,
        made_from=(plan.id, *plan.made_from),
        issued_s=inquiry.now_s,
        joints_rad=plan.start_joints_rad,
        devices_hash=devices_hash,
        guide=inquiry.case.guide,
        control_token=facts.approval.control_token,
        overrides=facts.overrides,
    )
