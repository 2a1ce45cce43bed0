"""What a modelled case may have."""

from dataclasses import dataclass


@dataclass
class Plan:
    """Why the arm is to move, and whether it did."""

    kind: str
    used: bool = False


@dataclass
class Permit:
    """What was approved, when, under whose control."""

    issued_s: float
    token: int
    guide: str


@dataclass
class Verdict:
    """Of a verification image."""

    passed: bool
    image: int
    at_s: float


@dataclass
class Sleeve:
    """Of the current attempt."""

    status: str
    verified: bool
    flagged: bool
    target: str | None  # the planned one


@dataclass
class Window:
    """A requested exposure."""

    opened_s: float
