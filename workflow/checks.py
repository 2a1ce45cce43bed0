"""Building blocks of the interlocks: from one question to one finding."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar

from workflow.facts import FACTS_OF, OVERRIDING
from workflow.findings import Finding, age_note, at_least, equals, fresh, is_true, within
from workflow.inquiry import Inquiry
from workflow.limits import Limits
from workflow.snapshot import Reading, SafetySnapshot
from workflow.triggers import Trigger
from workflow.verdicts import Measured, Verdict

F = TypeVar("F")
T = TypeVar("T")
Check = Callable[[Inquiry], Finding]
LimitOf = Callable[[Limits], float]
_TAKES_OVERRIDES = frozenset(trigger for trigger, kind in FACTS_OF.items() if kind in OVERRIDING)


class Identified(Protocol):
    """Anything with an id."""

    @property
    def id(self) -> str: ...


def id_of(artefact: Identified | None) -> str | None:
    """Its id, None where it is missing."""
    return artefact.id if artefact is not None else None


@dataclass(frozen=True, slots=True)
class Interlock:
    """One condition of safety: what it guards against, how it is judged and what may clear it."""

    code: str
    hazard: str
    message: str  # said when it refuses
    check: Check
    remedies: tuple[Trigger, ...] = ()  # none: the same request again, when the cause is gone
    asks: bool = False  # judged from what comes with the request or from the held button, not from the standing case
    hard: LimitOf | None = None  # how far a surgeon may override a magnitude, with a reason; None: never

    def judge(self, inquiry: Inquiry) -> Verdict:
        """The verdict, with what was measured and the limit."""
        found = self.check(inquiry)
        message = "" if found.passed else "; ".join(filter(None, (self.message, found.note)))
        verdict = Verdict(self.code, self.hazard, found.passed, found.measured, found.limit, found.unit, message)
        return verdict if self.hard is None else self._overridden(verdict, self.hard(inquiry.limits), inquiry)

    def _overridden(self, verdict: Verdict, hard_limit: float, inquiry: Inquiry) -> Verdict:
        """The verdict as the override in force makes it, if there is one; its limit is then the hard one."""
        if inquiry.trigger in _TAKES_OVERRIDES:
            verdict = replace(verdict, hard_limit=hard_limit)
        reason = next((one.reason for one in inquiry.overrides if one.code == self.code), None)
        if verdict.passed or reason is None:
            return verdict
        measured = verdict.measured if isinstance(verdict.measured, float) else None
        if not within(measured, hard_limit, verdict.unit).passed:
            return replace(verdict, limit=hard_limit, message=f"{verdict.message}; beyond what may be overridden")
        return replace(verdict, passed=True, limit=hard_limit, message=f"overridden: {reason}", override=reason)


def given(kind: type[F], value: Callable[[F], T | None]) -> Callable[[Inquiry], T | None]:
    """Picks a value from what came with the request, None if nothing of that kind came."""

    def pick(inquiry: Inquiry) -> T | None:
        facts = inquiry.given(kind)
        return None if facts is None else value(facts)

    return pick


def yes(pick: Callable[[Inquiry], bool | None]) -> Check:
    """A statement is known and true."""
    return lambda inquiry: is_true(pick(inquiry))


def bounded(pick: Callable[[Inquiry], float | None], limit: LimitOf, unit: str) -> Check:
    """A magnitude is known and within its limit."""
    return lambda inquiry: within(pick(inquiry), limit(inquiry.limits), unit)


def enough(pick: Callable[[Inquiry], float | None], limit: LimitOf, unit: str) -> Check:
    """A number is known and reaches its limit."""
    return lambda inquiry: at_least(pick(inquiry), limit(inquiry.limits), unit)


def reads(reading: Callable[[SafetySnapshot], Reading[bool]], expected: bool, age: LimitOf) -> Check:
    """A fresh reading of the snapshot says what is expected."""

    def check(inquiry: Inquiry) -> Finding:
        seen, age_s = reading(inquiry.snapshot), age(inquiry.limits)
        value = fresh(seen, age_s)
        return Finding(value is expected, value, expected, note=age_note(seen, age_s))

    return check


def reads_within(reading: Callable[[SafetySnapshot], Reading[float]], age: LimitOf, limit: LimitOf, unit: str) -> Check:
    """A fresh reading of the snapshot is within its limit."""

    def check(inquiry: Inquiry) -> Finding:
        seen, age_s = reading(inquiry.snapshot), age(inquiry.limits)
        found = within(fresh(seen, age_s), limit(inquiry.limits), unit)
        return replace(found, note=age_note(seen, age_s) or found.note)

    return check


def young(reading: Callable[[SafetySnapshot], Reading[Any]], age: LimitOf) -> Check:
    """A reading is not stale, whatever it says."""
    return lambda inquiry: within(reading(inquiry.snapshot).age_s, age(inquiry.limits), "s")


def since(start_s: Callable[[Inquiry], float | None], limit: LimitOf) -> Check:
    """A moment of the case is known and not longer ago than the limit."""

    def check(inquiry: Inquiry) -> Finding:
        start = start_s(inquiry)
        return within(None if start is None else inquiry.now_s - start, limit(inquiry.limits), "s")

    return check


def same(measured: Callable[[Inquiry], Measured], expected: Callable[[Inquiry], Measured]) -> Check:
    """Two things are known and the same."""
    return lambda inquiry: equals(measured(inquiry), expected(inquiry))


def joints_near(expected_rad: Callable[[Inquiry], Sequence[float] | None]) -> Check:
    """Every joint is where it is expected, within the tolerance of a permit."""

    def check(inquiry: Inquiry) -> Finding:
        seen, limits = inquiry.snapshot.joints_rad, inquiry.limits
        live, expected = fresh(seen, limits.feedback_age_s), expected_rad(inquiry)
        difference = None if live is None or expected is None else _largest_difference_rad(live, expected)
        found = within(difference, limits.permit_joint_rad, "rad")
        return replace(found, note=age_note(seen, limits.feedback_age_s) or found.note)

    return check


def _largest_difference_rad(a: Sequence[float], b: Sequence[float]) -> float:
    """NaN where the two cannot be compared, so that no limit passes."""
    if len(a) != len(b) or not a or not all(map(math.isfinite, (*a, *b))):
        return math.nan
    return max(abs(x - y) for x, y in zip(a, b, strict=True))
