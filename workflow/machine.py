"""The one way to change a case: a question in, a decision or a typed refusal out."""

from dataclasses import replace
from functools import reduce

from workflow.allowances import allowed, plan_kinds
from workflow.branches import choose
from workflow.case import CaseState
from workflow.decisions import Decision, ImageUse, Outcome
from workflow.engine import fire
from workflow.facts import FACTS_OF, Facts, Faulted, Restarted
from workflow.inquiry import Inquiry
from workflow.interlocks import PROVENANCE, judge
from workflow.limits import Limits
from workflow.links import Link
from workflow.refusals import Refusal
from workflow.refusing import refuse
from workflow.rows import Goto, Row
from workflow.settling import settle
from workflow.snapshot import SafetySnapshot, unknown_snapshot
from workflow.states import State
from workflow.totality import CELLS
from workflow.triggers import Kind, Trigger
from workflow.verdicts import Verdict

__all__ = ["allowed", "decide", "plan_kinds", "restarted"]

_PROVENANCE = frozenset(lock.code for lock in PROVENANCE)


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
    inquiry = Inquiry(case, trigger, facts, snapshot or unknown_snapshot(), limits, now_s)
    verdicts = judge(inquiry)
    entry = CELLS[case.state, trigger, choose(inquiry, verdicts)]
    if trigger.kind is Kind.REQUEST and trigger is not Trigger.STOP:
        refusal = refuse(inquiry, verdicts, isinstance(entry, Row))
        if refusal is not None:
            return refusal
    return _walked(inquiry, verdicts, entry) if isinstance(entry, Row) else _unlisted(inquiry, verdicts)


def restarted(case: CaseState, now_s: float, limits: Limits) -> Decision:
    """What a restart of the service does to a case: safe_hold, the view and everything below it void."""
    facts = Restarted()
    inquiry = Inquiry(case, Trigger.RESTARTED, facts, unknown_snapshot(), limits, now_s)
    entry = CELLS[case.state, Trigger.RESTARTED, choose(inquiry, ())]
    return _walked(inquiry, (), entry) if isinstance(entry, Row) else _unlisted(inquiry, ())


def _unlisted(inquiry: Inquiry, verdicts: tuple[Verdict, ...]) -> Decision:
    observed = inquiry.trigger.kind is Kind.OBSERVATION
    return Decision(
        trigger=inquiry.trigger,
        row=None,
        outcome=Outcome.LATE if observed else Outcome.RECORDED,
        after=inquiry.case,
        voided=(),
        effects=(),
        verdicts=verdicts,
        image_use=None,
        taken_as=inquiry.trigger,
    )


def _walked(inquiry: Inquiry, verdicts: tuple[Verdict, ...], row: Row) -> Decision:
    after = _after(inquiry, row)
    return Decision(
        trigger=inquiry.trigger,
        row=row.number,
        outcome=Outcome.TAKEN,
        after=after,
        voided=_voided(inquiry.case, after),
        effects=row.effects,
        verdicts=verdicts,
        image_use=_image_use(row, verdicts),
        taken_as=row.taken_as or inquiry.trigger,
    )


def _after(inquiry: Inquiry, row: Row) -> CaseState:
    case = inquiry.case
    changed = reduce(lambda so_far, change: change(so_far, inquiry), row.changes, case)
    match row.to:
        case Goto.SAME:
            to = case.state
        case Goto.SETTLE:
            to = settle(changed)
        case _:
            to = row.to
    state = fire(case.state, row, to)
    if state is not case.state:
        # Nothing that was approved or asked for outlives the state that it was approved in.
        changed = replace(changed, permit=None, window=None)
    return replace(changed, state=state, held_for=_held_for(inquiry, state))


def _held_for(inquiry: Inquiry, state: State) -> str | None:
    """The first cause of a hold stays, unless a fault is the newer one: that is latched."""
    if state is not State.SAFE_HOLD:
        return None
    if isinstance(inquiry.facts, Faulted):
        return inquiry.facts.kind.value
    return inquiry.case.held_for or inquiry.trigger.value


def _voided(before: CaseState, after: CaseState) -> tuple[str, ...]:
    """Ids that are no longer in the chain; a consumed permit was used, not voided."""
    kept = {artefact.id for link in Link if (artefact := after.link(link))} | {after.used_permit_id}
    return tuple(artefact.id for link in Link if (artefact := before.link(link)) and artefact.id not in kept)


def _image_use(row: Row, verdicts: tuple[Verdict, ...]) -> ImageUse | None:
    match row.trigger, row.number:
        case Trigger.IMAGE_ARRIVED, 3:
            return ImageUse.REGISTRATION
        case Trigger.IMAGE_ARRIVED, 4:
            return ImageUse.VERIFICATION
        case Trigger.IMAGE_ARRIVED, _:
            doubtful = any(not verdict.passed for verdict in verdicts if verdict.code in _PROVENANCE)
            return ImageUse.QUARANTINED if doubtful else ImageUse.UNASSIGNED
        case _:
            return None
