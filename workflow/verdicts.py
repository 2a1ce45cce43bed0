"""What an interlock found."""

from dataclasses import dataclass

Measured = float | str | bool | None


@dataclass(frozen=True, slots=True)
class Verdict:
    """One interlock's answer, stored with every attempt whether it passed or not."""

    code: str
    hazard: str
    passed: bool
    measured: Measured
    limit: Measured
    unit: str
    message: str
