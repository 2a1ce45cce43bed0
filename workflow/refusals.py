"""Why a request is refused, and what leads onwards."""

from dataclasses import dataclass
from enum import StrEnum

from workflow.states import State
from workflow.triggers import Trigger
from workflow.verdicts import Verdict


class RefusalCode(StrEnum):
    """Stable codes; the first seven in the order in which they are tried, then a row's own guards."""

    CASE_OVER = "case_over"
    HELD = "held"
    ARM_MOVING = "arm_moving"
    INSTRUMENT_IN_GUIDE = "instrument_in_guide"
    INSERTION_RUNNING = "insertion_running"
    MISSING = "missing"
    NOT_NOW = "not_now"
    REASON_REQUIRED = "reason_required"
    ROLE = "role"
    TARGETS_OPEN = "targets_open"
    NOT_OVERRIDABLE = "not_overridable"
    INTERLOCK = "interlock"


@dataclass(frozen=True, slots=True)
class Refusal:
    """A request that changed nothing; all verdicts are here, so that the attempt can be stored whole.

    With code `interlock`, `verdicts` holds those that failed beside those that passed.
    """

    code: RefusalCode
    message: str
    trigger: Trigger
    state: State
    leads_onwards: tuple[Trigger, ...]
    verdicts: tuple[Verdict, ...]

    @property
    def failed(self) -> tuple[Verdict, ...]:
        """The verdicts that refused."""
        return tuple(verdict for verdict in self.verdicts if not verdict.passed)
