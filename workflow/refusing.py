"""Why a request is refused: the first reason that applies, in a fixed order, and what leads onwards."""

from collections.abc import Sequence

from workflow.facts import (
    Acknowledged,
    CaseClosed,
    CorrectionRequested,
    LeaseTaken,
    Paper,
    PlanRequested,
    Reasoned,
    TargetDone,
)
from workflow.inquiry import Inquiry
from workflow.interlocks import INTERLOCKS
from workflow.needs import GUARDED_BY_CHAIN, MAKERS, first_missing
from workflow.onwards import from_the_guide, from_the_insertion, route, towards
from workflow.plans import PLAN_STATES
from workflow.refusals import Refusal, RefusalCode
from workflow.states import INSERTION, OVER, GuideState, State
from workflow.triggers import Trigger
from workflow.verdicts import Verdict

Reason = tuple[RefusalCode, str, tuple[Trigger, ...]]
# A second correction may be noise; a third asks a person what is going on.
_FREE_CORRECTIONS = 2
_REASON_ALWAYS = frozenset({Trigger.RETAKE, Trigger.TARGET_WITHDRAWN, Trigger.VERIFICATION_REJECTED})


def refuse(inquiry: Inquiry, verdicts: Sequence[Verdict], is_listed: bool) -> Refusal | None:
    """A refusal with every verdict, or None if the request may be taken."""
    reason = _reason(inquiry, verdicts, is_listed)
    if reason is None:
        return None
    code, message, leads_onwards = reason
    return Refusal(code, message, inquiry.trigger, inquiry.case.state, leads_onwards, tuple(verdicts))


def _reason(inquiry: Inquiry, verdicts: Sequence[Verdict], is_listed: bool) -> Reason | None:
    by_state = None if is_listed else _by_state(inquiry)
    by_guide = by_state or _by_guide(inquiry, verdicts)
    by_insertion = by_guide or (None if is_listed else _by_insertion(inquiry))
    needs_chain = not is_listed or inquiry.trigger in GUARDED_BY_CHAIN
    by_chain = by_insertion or (_by_chain(inquiry) if needs_chain else None)
    if by_chain or not is_listed:
        return by_chain or _not_now(inquiry)
    return (
        _by_plan_kind(inquiry)
        or _by_what_came(inquiry)
        or _by_override(inquiry, verdicts)
        or _by_interlock(inquiry, verdicts)
    )


def _by_state(inquiry: Inquiry) -> Reason | None:
    match inquiry.case.state:
        case state if state in OVER:
            return RefusalCode.CASE_OVER, f"the case is {state}", (Trigger.READ, Trigger.EXPORT, Trigger.NOTE)
        case State.SAFE_HOLD:
            return RefusalCode.HELD, f"held: {inquiry.case.held_for}", (Trigger.ACKNOWLEDGED,)
        case State.MOVING:
            return RefusalCode.ARM_MOVING, "the arm is moving", (Trigger.RELEASED, Trigger.STOP)
        case _:
            return None


def _by_guide(inquiry: Inquiry, verdicts: Sequence[Verdict]) -> Reason | None:
    case = inquiry.case
    match inquiry.trigger:
        case Trigger.CASE_CLOSED:
            in_the_way = case.guide is not GuideState.EMPTY
        case Trigger.TARGET_DONE:
            in_the_way = case.state in INSERTION and case.guide not in (GuideState.EMPTY, GuideState.WIRE)
        case _:
            in_the_way = any(verdict.code == "guide_empty" and not verdict.passed for verdict in verdicts)
    if not in_the_way:
        return None
    return RefusalCode.INSTRUMENT_IN_GUIDE, f"in the guide: {case.guide}", from_the_guide(case)


def _by_insertion(inquiry: Inquiry) -> Reason | None:
    if inquiry.case.state not in INSERTION:
        return None
    return RefusalCode.INSERTION_RUNNING, "a sleeve is being inserted or in place", from_the_insertion(inquiry.case)


def _by_chain(inquiry: Inquiry) -> Reason | None:
    missing = first_missing(inquiry.case, inquiry.trigger, inquiry.plan_kind)
    if missing is None:
        return None
    return RefusalCode.MISSING, f"no valid {missing}", towards(inquiry.case, MAKERS[missing])


def _not_now(inquiry: Inquiry) -> Reason:
    case, trigger = inquiry.case, inquiry.trigger
    return RefusalCode.NOT_NOW, f"not while the case is {case.state}", towards(case, trigger)


def _by_plan_kind(inquiry: Inquiry) -> Reason | None:
    plan = inquiry.given(PlanRequested)
    if plan is None or inquiry.case.state in PLAN_STATES[plan.kind]:
        return None
    message = f"no {plan.kind} plan while the case is {inquiry.case.state}"
    return RefusalCode.NOT_NOW, message, route(inquiry.case, PLAN_STATES[plan.kind])


def _by_what_came(inquiry: Inquiry) -> Reason | None:
    again = (inquiry.trigger,)
    match inquiry.facts:
        case Reasoned(reason="") if inquiry.trigger in _REASON_ALWAYS:
            return RefusalCode.REASON_REQUIRED, "this needs a reason", again
        case LeaseTaken(reason=""):
            return RefusalCode.REASON_REQUIRED, "taking control needs a reason", again
        case TargetDone(placed=False, reason=""):
            return RefusalCode.REASON_REQUIRED, "abandoning a target needs a reason", again
        case CorrectionRequested(reason="") if inquiry.case.corrections >= _FREE_CORRECTIONS:
            return RefusalCode.REASON_REQUIRED, "the third correction needs a reason", again
        case Acknowledged(surgeon=False):
            return RefusalCode.ROLE, "only a surgeon may acknowledge", again
        case Paper(permitted=False):
            return RefusalCode.ROLE, "not permitted to this role", again
        case CaseClosed(open_targets=number) if number != 0:
            message = f"{number} targets are neither placed nor abandoned with a reason"
            return RefusalCode.TARGETS_OPEN, message, (Trigger.TARGET_DONE, Trigger.TARGET_WITHDRAWN)
        case _:
            return None


def _by_override(inquiry: Inquiry, verdicts: Sequence[Verdict]) -> Reason | None:
    """Who may not override, why not said, or what never yields: of all that come with the request."""
    if inquiry.trigger is Trigger.MOVE_STARTED:
        return None  # those of the permit were judged when it was given
    overridable = {verdict.code for verdict in verdicts if verdict.hard_limit is not None}
    again = (inquiry.trigger,)
    for override in inquiry.overrides:
        if not override.surgeon:
            return RefusalCode.ROLE, "only a surgeon may override an interlock", again
        if not override.reason:
            return RefusalCode.REASON_REQUIRED, f"overriding {override.code} needs a reason", again
        if override.code not in overridable:
            return RefusalCode.NOT_OVERRIDABLE, f"{override.code} is not to be overridden here", again
    return None


def _by_interlock(inquiry: Inquiry, verdicts: Sequence[Verdict]) -> Reason | None:
    failed = [verdict for verdict in verdicts if not verdict.passed]
    if not failed:
        return None
    message = "; ".join(verdict.message for verdict in failed)
    remedies = (remedy for verdict in failed for remedy in INTERLOCKS[verdict.code].remedies)
    steps = (step for remedy in remedies for step in towards(inquiry.case, remedy))
    onwards = dict.fromkeys(step for step in steps if step is not inquiry.trigger)
    # Without a remedy of its own the cause is in the room: the same request again, when it is gone.
    return RefusalCode.INTERLOCK, message, tuple(onwards) or (inquiry.trigger,)
