"""The one way to change a case."""

from workflow.case import CaseState
from workflow.decisions import Allowance, Decision
from workflow.facts import FACTS_OF, Facts, Restarted
from workflow.limits import Limits
from workflow.refusals import Refusal
from workflow.snapshot import SafetySnapshot
from workflow.triggers import Trigger


def decide(
    case: CaseState,
    trigger: Trigger,
    facts: Facts,
    snapshot: SafetySnapshot | None,
    limits: Limits,
    now_s: float,
) -> Decision | Refusal:
    """Take or refuse a trigger; observations and facts are never refused, nor is stop.

    `now_s` is the monotonic clock; None for a snapshot means that nothing is known, so that every interlock refuses.

    Raises
    ------
    ValueError
        If the facts are not those of the trigger.
    """
    if type(facts) is not FACTS_OF[trigger]:
        raise ValueError(f"{trigger} comes with {FACTS_OF[trigger].__name__}, not {type(facts).__name__}")
    raise NotImplementedError((case, snapshot, limits, now_s))


def allowed(case: CaseState, snapshot: SafetySnapshot | None, limits: Limits, now_s: float) -> dict[Trigger, Allowance]:
    """For every request: whether it would be taken now, else every reason why not and what leads onwards."""
    raise NotImplementedError((case, snapshot, limits, now_s))


def restarted(case: CaseState, now_s: float, limits: Limits) -> Decision:
    """What a restart of the service does to a case: safe_hold, the view and everything below it void."""
    decision = decide(case, Trigger.RESTARTED, Restarted(), None, limits, now_s)
    assert isinstance(decision, Decision)  # noqa: S101  an observation is never refused
    return decision
