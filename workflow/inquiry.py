"""One question to the rules: the case, what happened or is asked, and what is known of the world."""

from dataclasses import dataclass
from typing import TypeVar

from workflow.case import CaseState, Plan
from workflow.facts import OVERRIDING, Facts, PlanRequested
from workflow.limits import Limits
from workflow.overrides import Override
from workflow.plans import PlanKind
from workflow.snapshot import SafetySnapshot
from workflow.triggers import Trigger

F = TypeVar("F")


@dataclass(frozen=True, slots=True)
class Inquiry:
    """Everything that guards, interlocks and changes may look at; `facts` is None where only the standing is asked."""

    case: CaseState
    trigger: Trigger
    facts: Facts | None
    snapshot: SafetySnapshot
    limits: Limits
    now_s: float

    def given(self, kind: type[F]) -> F | None:
        """What came with the trigger, if it is of this kind."""
        return self.facts if isinstance(self.facts, kind) else None

    def told(self, kind: type[F]) -> F:
        """What came with the trigger.

        Raises
        ------
        ValueError
            If nothing of this kind came.
        """
        if not isinstance(self.facts, kind):
            raise ValueError(f"{self.trigger} was asked without its {kind.__name__}")
        return self.facts

    @property
    def plan(self) -> Plan | PlanRequested | None:
        """The plan that the request is about: the one that comes with it, or that of the case."""
        return self.given(PlanRequested) if self.trigger is Trigger.PLAN_REQUESTED else self.case.plan

    @property
    def plan_kind(self) -> PlanKind | None:
        """Its kind."""
        return self.plan.kind if self.plan else None

    @property
    def overrides(self) -> tuple[Override, ...]:
        """Those in force: what comes with the request; a motion that starts has those of its permit."""
        if self.trigger is Trigger.MOVE_STARTED:
            return self.case.permit.overrides if self.case.permit else ()
        return self.facts.overrides if isinstance(self.facts, OVERRIDING) else ()
