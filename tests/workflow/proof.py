"""The proof of one interlock: where it is met, and what is different from a case in which all is well."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from workflow import facts as f
from workflow.case import CaseState, Insertion
from workflow.decisions import Decision
from workflow.limits import Limits
from workflow.plans import PlanKind
from workflow.refusals import Refusal
from workflow.snapshot import Reading
from workflow.states import InsertionStatus, State
from workflow.triggers import Trigger

LIMITS = Limits(motion_chi_square=18.5)
NAN = math.nan
UNKNOWN = Reading(None, 0.01)
ELSEWHERE = (9.0, -1.2, 1.3, -0.4, 1.5, 0.2)
# Just beyond a limit, relatively: far above rounding, far below anything that matters.
MORE = 1.0 + 1e-6


@dataclass(frozen=True)
class Spoil:
    """One thing that is different from a case in which all is well."""

    readings: dict[str, Reading] = field(default_factory=dict)
    facts: dict[str, Any] = field(default_factory=dict)
    quality: dict[str, Any] = field(default_factory=dict)
    later_s: float = 0.0
    case: Callable[[CaseState], CaseState] = lambda case: case


@dataclass(frozen=True)
class Proof:
    """Where an interlock is met, what it lets pass and what it refuses."""

    state: State
    trigger: Trigger
    refusing: list[Spoil]
    passing: list[Spoil]
    kind: PlanKind = PlanKind.TARGETING


def reading(name: str, value: Any, age_s: float = 0.01) -> Spoil:
    return Spoil(readings={name: Reading(value, age_s)})


def given(**facts: Any) -> Spoil:
    return Spoil(facts=facts)


def of_quality(**quality: Any) -> Spoil:
    return Spoil(quality=quality)


def surgery(**changes: Any) -> Spoil:
    """A case that no trigger can make: the interlock is the second line behind the voiding."""
    return Spoil(case=lambda case: replace(case, **changes))


def nested(link: str, **changes: Any) -> Spoil:
    return Spoil(case=lambda case: replace(case, **{link: replace(getattr(case, link), **changes)}))


def said(name: str, value: bool, age_s: float) -> tuple[list[Spoil], list[Spoil]]:
    """A reading that must say something: the opposite, unknown, stale, from the future or of no age refuse."""
    wrong = [(not value, 0.01), (None, 0.01), (value, age_s * MORE), (value, -0.01), (value, NAN)]
    return [reading(name, *bad) for bad in wrong], [reading(name, value, age_s)]


def measured(name: str, limit: float, age_s: float) -> tuple[list[Spoil], list[Spoil]]:
    """A reading with a limit: beyond it, negative, unknown, stale or no number refuse."""
    wrong = [(limit * MORE, 0.01), (-0.01, 0.01), (None, 0.01), (NAN, 0.01), (0.0, age_s * MORE), (0.0, NAN)]
    return [reading(name, *bad) for bad in wrong], [reading(name, limit), reading(name, 0.0, age_s)]


def stated(name: str) -> tuple[list[Spoil], list[Spoil]]:
    return [given(**{name: False}), given(**{name: None})], [given(**{name: True})]


def most(make: Callable[..., Spoil], name: str, limit: float) -> tuple[list[Spoil], list[Spoil]]:
    return [make(**{name: bad}) for bad in (limit * MORE, -0.01, None, NAN, math.inf)], [make(**{name: limit})]


def least(name: str, limit: float) -> tuple[list[Spoil], list[Spoil]]:
    return [given(**{name: bad}) for bad in (limit / MORE, -1.0, None, NAN)], [given(**{name: limit})]


FEEDBACK, HEARTBEAT, RECORD = LIMITS.feedback_age_s, LIMITS.heartbeat_age_s, LIMITS.record_age_s
OTHER = f.Approval("surgeon", surgeon=True, pin_confirmed=True, control_token=1)
REGISTER = (State.IMAGE_ACQUIRED, Trigger.REGISTRATION_COMPLETED)
ARRIVE = (State.CARM_POSITIONED, Trigger.IMAGE_ARRIVED)
APPROVE = (State.TARGET_CHOSEN, Trigger.MOVE_APPROVED)
START = (State.TARGET_CHOSEN, Trigger.MOVE_STARTED)
JUDGE = (State.MOVED, Trigger.VERIFICATION_PASSED)
INSERT = (State.VERIFIED, Trigger.INSERTION_STARTED)
TARGET = (State.REGISTERED, Trigger.TARGET_CONFIRMED)
PLAN = (State.TARGET_CHOSEN, Trigger.PLAN_REQUESTED)
ACKNOWLEDGE = (State.SAFE_HOLD, Trigger.ACKNOWLEDGED)
SLEEVE = Insertion("insertion", InsertionStatus.OPEN, verified=True, flagged=False)
ANGLE_LEFT = LIMITS.angle_error_rad - math.radians(0.1)  # beside the bound that the usual facts carry
POSITION_LEFT = LIMITS.position_error_mm - 0.1


def failed(answer: Decision | Refusal) -> set[str]:
    """The interlocks that did not pass."""
    return {verdict.code for verdict in answer.verdicts if not verdict.passed}
