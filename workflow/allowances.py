"""What may be asked now: the part of the status object that a tablet shows."""

from collections.abc import Mapping
from types import MappingProxyType

from workflow.case import CaseState
from workflow.decisions import Allowance
from workflow.inquiry import Inquiry
from workflow.interlocks import judge
from workflow.limits import Limits
from workflow.needs import first_missing
from workflow.plans import PLAN_STATES, PlanKind
from workflow.refusing import refuse
from workflow.snapshot import SafetySnapshot, unknown_snapshot
from workflow.totality import listed
from workflow.triggers import REQUESTS, Trigger


def allowed(
    case: CaseState,
    snapshot: SafetySnapshot | None,
    limits: Limits,
    now_s: float,
    own: Mapping[Trigger, SafetySnapshot] = MappingProxyType({}),
) -> dict[Trigger, Allowance]:
    """For every request: whether it would be taken now, else every reason why not and what leads onwards.

    What comes with a request, and whether the button is held, is not known before it is made and not judged here.
    `own` holds the snapshots of triggers that rely on another image than the case's.
    """
    known = snapshot or unknown_snapshot()
    return {
        trigger: _allowance(Inquiry(case, trigger, None, own.get(trigger, known), limits, now_s))
        for trigger in REQUESTS
    }


def _allowance(inquiry: Inquiry) -> Allowance:
    refusal = refuse(inquiry, judge(inquiry), listed(inquiry.case.state, inquiry.trigger))
    if refusal is None:
        return Allowance(allowed=True, code=None, message="", reasons=(), leads_onwards=())
    return Allowance(
        allowed=False,
        code=refusal.code,
        message=refusal.message,
        reasons=refusal.failed,
        leads_onwards=refusal.leads_onwards,
    )


def plan_kinds(case: CaseState) -> tuple[PlanKind, ...]:
    """Kinds of plans that may be asked for now."""
    return tuple(
        kind
        for kind in PlanKind
        if case.state in PLAN_STATES[kind] and first_missing(case, Trigger.PLAN_REQUESTED, kind) is None
    )
