"""Why the rules make nothing of what image work found, and what leads onwards: told as of an image that it refused."""

from collections.abc import Iterable, Mapping
from typing import Any

from sqlalchemy.engine import Connection

from service.cases import store
from service.cases.records import StoredEvent
from service.errors import ANSWERS, ErrorCode
from workflow.case import CaseState
from workflow.decisions import Decision
from workflow.interlocks import INTERLOCKS
from workflow.onwards import towards
from workflow.triggers import Trigger
from workflow.verdicts import Verdict
from workflow.verification_interlocks import EVALUATIONS_AGREE

Json = dict[str, Any]
_REFUSED = (Trigger.REGISTRATION_REFUSED, Trigger.VERIFICATION_REFUSED)
_DISAGREED = (ErrorCode.EVALUATIONS_DISAGREE, ErrorCode.EVALUATIONS_DISAGREE_AGAIN)


def why_unusable(connection: Connection, decision: Decision, found: Mapping[str, Any]) -> Json:
    """For the event of a result that the rules refuse: `reason`, `what_to_do`, `leads_onwards`; of any other nothing.

    `found` is what image work measured. The first verdict that refuses is the reason, all of them are in the record.
    """
    if decision.taken_as not in _REFUSED or decision.trigger in _REFUSED:
        return {}
    refusing = next(verdict for verdict in decision.verdicts if not verdict.passed)
    if refusing.code == EVALUATIONS_AGREE.code:
        return _disagreement(connection, decision.after, found)
    return _told(decision.after, refusing.code, _reason(refusing), INTERLOCKS[refusing.code].remedies)


def what_to_do(code: str) -> str:
    """The sentence for a code, "" for one that no table has: an interlock's, whose remedies say it."""
    return ANSWERS[code].what_to_do if code in ANSWERS else ""


def _disagreement(connection: Connection, case: CaseState, found: Mapping[str, Any]) -> Json:
    """H33: noise is gone in another image, a guide that is not as its file says is not.

    About a target on the axis the two agree whatever the guide is; a registration where the guide is now brings it
    there.
    """
    if _has_disagreed(connection, case):
        again = "exposing once more brought the same: paper and contour evaluation disagree"
        reason = {"message": again, **_how_far(found)}
        return _told(case, ErrorCode.EVALUATIONS_DISAGREE_AGAIN, reason, [Trigger.TARGET_WITHDRAWN])
    reason = {"message": EVALUATIONS_AGREE.message, **_how_far(found)}
    return _told(case, ErrorCode.EVALUATIONS_DISAGREE, reason, [Trigger.EXPOSURE_REQUESTED])


def _has_disagreed(connection: Connection, case: CaseState) -> bool:
    """Whether an earlier image of the same motion was refused for this."""
    refused = store.events_of_kind(connection, case.case_id, [Trigger.VERIFICATION_REFUSED])
    return any(_code(event) in _DISAGREED and _motion_id(event) == _id_of_motion(case) for event in refused)


def _code(event: StoredEvent) -> str | None:
    return (event.data.get("reason") or {}).get("code")


def _motion_id(event: StoredEvent) -> str | None:
    return (event.case_state.get("motion") or {}).get("id")


def _id_of_motion(case: CaseState) -> str | None:
    return case.motion.id if case.motion is not None else None


def _how_far(found: Mapping[str, Any]) -> Json:
    """The difference that is beyond its limit: of the positions where it is both."""
    difference, limit = found["difference"], found["difference_limit"]
    beyond = difference["position_error_mm"] > limit["position_error_mm"]
    name, unit = ("position_error_mm", "mm") if beyond else ("angle_error_deg", "deg")
    return {"measured": difference[name], "limit": limit[name], "unit": unit}


def _reason(verdict: Verdict) -> Json:
    return {name: getattr(verdict, name) for name in ("message", "measured", "limit", "unit")}


def _told(case: CaseState, code: str, reason: Json, remedies: Iterable[Trigger]) -> Json:
    steps = dict.fromkeys(step for remedy in remedies for step in towards(case, remedy))
    onwards = [step.value for step in steps if step is not Trigger.NEWEST_IMAGE_REUSED]  # that is the refused one
    return {"reason": {"code": code} | reason, "what_to_do": what_to_do(code), "leads_onwards": onwards}
