"""Comparisons that fail closed: unknown, stale, negative or not a number never passes."""

import math
from dataclasses import dataclass
from typing import TypeVar

from workflow.snapshot import Reading
from workflow.verdicts import Measured

T = TypeVar("T")
# Limits that arrive through degrees and back may differ in the last bit.
_ROUNDING = 1.0 + 1e-9


@dataclass(frozen=True, slots=True)
class Finding:
    """What was measured against which limit; `note` says why nothing could be measured."""

    passed: bool
    measured: Measured
    limit: Measured
    unit: str = ""
    note: str = ""


def within(measured: float | None, limit: float, unit: str) -> Finding:
    """A magnitude is known, finite and at most its limit."""
    if measured is None or not math.isfinite(measured):
        return _unmeasured(measured, limit, unit)
    return Finding(0.0 <= measured <= limit * _ROUNDING, measured, limit, unit)


def at_least(measured: float | None, limit: float, unit: str) -> Finding:
    """A number is known, finite and at least its limit."""
    if measured is None or not math.isfinite(measured):
        return _unmeasured(measured, limit, unit)
    return Finding(measured >= limit, measured, limit, unit)


def _unmeasured(measured: float | None, limit: float, unit: str) -> Finding:
    """Nothing that JSON could not hold goes into a record."""
    return Finding(False, None, limit, unit, "unknown" if measured is None else "not a finite number")


def is_true(measured: bool | None) -> Finding:
    """A statement is known and true."""
    return Finding(measured is True, measured, True)


def equals(measured: Measured, expected: Measured) -> Finding:
    """Two known values are the same."""
    return Finding(measured is not None and measured == expected, measured, expected)


def is_fresh(reading: Reading[T], age_limit_s: float) -> bool:
    """The reading's age is a number between zero and the limit."""
    return 0.0 <= reading.age_s <= age_limit_s


def fresh(reading: Reading[T], age_limit_s: float) -> T | None:
    """The value of a reading, None if it is stale."""
    return reading.value if is_fresh(reading, age_limit_s) else None


def age_note(reading: Reading[T], age_limit_s: float) -> str:
    """Why a reading does not count, empty if it does."""
    if is_fresh(reading, age_limit_s):
        return "" if reading.value is not None else "unknown"
    return f"the reading is {reading.age_s:.3g} s old, at most {age_limit_s:.3g} s count"
