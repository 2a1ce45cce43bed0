"""A surgeon lets an interlock pass beyond its limit: with a reason, and for the one request that it comes with."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Override:
    """Which interlock, why, and whether a surgeon says so."""

    code: str
    reason: str
    surgeon: bool
