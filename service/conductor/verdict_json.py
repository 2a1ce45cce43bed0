"""A verdict as a caller sees it, and as the record keeps it."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from service.cases.records import NewVerdict
from workflow.verdicts import Verdict

_TOLD = tuple(field.name for field in fields(Verdict))
_KEPT = tuple(field.name for field in fields(NewVerdict))


def plain_verdict(verdict: Verdict) -> dict[str, Any]:
    """Field by field; none of the values needs to be copied."""
    return {name: getattr(verdict, name) for name in _TOLD}


def verdict_json(verdict: Verdict) -> dict[str, Any]:
    """With whether a surgeon's override would let it pass, so that a tablet needs no rule of its own."""
    return plain_verdict(verdict) | {"overridable": verdict.overridable}


def kept_verdict(verdict: Mapping[str, Any]) -> NewVerdict:
    """What the record keeps; the reason of an override is its message."""
    return NewVerdict(**{name: verdict[name] for name in _KEPT})
