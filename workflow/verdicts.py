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
    hard_limit: float | None = None  # up to here a surgeon may override it with this request; None: never
    override: str | None = None  # the surgeon's reason, where it passed only for that

    @property
    def overridable(self) -> bool:
        """It refuses, and an override would let it pass."""
        measured, hard_limit = self.measured, self.hard_limit
        if self.passed or hard_limit is None or not isinstance(measured, float):
            return False
        return 0.0 <= measured <= hard_limit
