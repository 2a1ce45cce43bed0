"""What the rules decided and what people signed, as data: refusals, interlocks, overrides, stops, signatures, proof."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from service.cases.records import ArtefactKind, Json, StoredEvent
from service.report.case_part import Row
from service.report.record import CaseRecord
from service.report.wording import NOT_TOLD, NOTHING, clock, measured, measured_range, moment, words
from workflow.triggers import Trigger

_STOPPING = (
    Trigger.STOP,
    Trigger.FAULT,
    Trigger.RESTARTED,
    Trigger.HOLD_REQUESTED,
    Trigger.ARM_DISTURBED,
    Trigger.CASE_ABORTED,
    Trigger.ACKNOWLEDGED,
)
_SAID = (
    Trigger.NOTE,
    Trigger.LABEL,
    Trigger.RETAKE,
    Trigger.TARGET_WITHDRAWN,
    Trigger.VERIFICATION_REJECTED,
    Trigger.INSERTION_CANCELLED,
    Trigger.PATIENT_MOVED,
    Trigger.HAND_GUIDED,
    Trigger.DEVICE_CHANGED,
)
# A verification is asked about as one that passed, and the verdicts say whether it did.
_ASKED = {Trigger.VERIFICATION_PASSED.value: "verification judged"}
_SIGNED = (Trigger.MOVE_APPROVED, Trigger.INSERTION_STARTED, Trigger.CASE_CLOSED)
_WORDS = ("text", "label", "purpose", "reason", "what", "message")


def decided(record: CaseRecord) -> str:
    """How many requests and observations the rules decided."""
    refused = sum(not one["accepted"] for one in record.decisions)
    verdicts = sum(len(one["verdicts"]) for one in record.decisions)
    return f"{len(record.decisions)} decisions with {verdicts} verdicts of interlocks; {refused} refused."


def failures(record: CaseRecord) -> list[list[str | list[str]]]:
    """When, who, what was asked or seen, whether it was refused, and a line for each failed interlock."""
    return [
        [
            clock(one["recorded_at"]),
            record.person(one["user_id"]),
            _ASKED.get(one["trigger"]) or words(one["trigger"]),
            "recorded" if one["accepted"] else "refused",
            _why_not(one),
        ]
        for one in record.decisions
        if not one["accepted"] or not all(verdict["passed"] for verdict in one["verdicts"])
    ]


def _why_not(decision: Json) -> list[str]:
    failed = [_told(verdict) for verdict in decision["verdicts"] if not verdict["passed"]]
    return failed or [decision["message"] or words(decision["code"])]


def _told(verdict: Json) -> str:
    value, limit = (measured(verdict[name], verdict["unit"]) for name in ("measured", "limit"))
    return f"{verdict['code']}: {value}, limit {limit}; {verdict['message']} ({verdict['hazard']})"


@dataclass(slots=True)
class _Tally:
    """How often an interlock was asked, and the range that it measured."""

    verdict: Json
    judged: int = 0
    failed: int = 0
    unknown: int = 0
    values: list[float] = field(default_factory=list)


def interlocks(record: CaseRecord) -> list[Row]:
    """Each interlock once: hazard, how often it judged and failed, the range it measured, its newest limit."""
    tallies: dict[tuple[str, str], _Tally] = {}
    for decision in record.decisions:
        for verdict in decision["verdicts"]:
            tally = tallies.setdefault((verdict["hazard"], verdict["code"]), _Tally(verdict))
            _count(tally, verdict)
    return [_interlock(hazard, code, tallies[hazard, code]) for hazard, code in sorted(tallies)]


def _count(tally: _Tally, verdict: Json) -> None:
    value = verdict["measured"]
    tally.unknown += value is None
    tally.verdict = verdict
    tally.judged += 1
    tally.failed += not verdict["passed"]
    if isinstance(value, int | float) and not isinstance(value, bool):
        tally.values.append(float(value))


def _interlock(hazard: str, code: str, tally: _Tally) -> Row:
    unit, limit = tally.verdict["unit"], tally.verdict["limit"]
    values, shown = NOTHING, NOTHING
    if tally.values:
        values, shown = measured_range(tally.values, unit), measured(limit, unit)
        values += f", {tally.unknown} unknown" if tally.unknown else ""
    return [hazard, code, str(tally.judged), str(tally.failed), values, shown]


def overrides(record: CaseRecord) -> list[Row]:
    """When, who, with which request, which interlock, why."""
    return list(_overrides(record))


def _overrides(record: CaseRecord) -> Iterator[Row]:
    for event in record.events:
        given: Mapping[str, str] = event.data.get("overrides") or {}
        for code, reason in given.items():
            yield [clock(event.recorded_at), record.person(event.user_id), words(event.trigger), code, reason]


def stops(record: CaseRecord) -> list[Row]:
    """Stops, faults and holds with their acknowledgements: when, who, what, words, and the state after it."""
    return [_event(record, event) for event in record.events if event.trigger in _STOPPING]


def statements(record: CaseRecord) -> list[Row]:
    """Notes, and what people stated or gave up, in the same columns."""
    return [_event(record, event) for event in record.events if event.trigger in _SAID]


def _event(record: CaseRecord, event: StoredEvent) -> Row:
    who, what = record.person(event.user_id), words(event.trigger)
    return [clock(event.recorded_at), who, what, "; ".join(_said(event.data)), words(event.state)]


def _said(data: Json) -> Iterator[str]:
    if data.get("cause"):
        yield words(data["cause"])
    if data.get("emergency_access"):
        yield "emergency access: the arm was left to the pendant"
    if "guide" in data:
        yield f"guide stated {data['guide']}"
    yield from (str(data[name]) for name in _WORDS if data.get(name))


def signatures(record: CaseRecord) -> list[Row]:
    """When, who, what they signed."""
    return [
        [clock(event.recorded_at), record.person(event.user_id), _signed(record, event)]
        for event in record.events
        if event.trigger in _SIGNED
    ]


def _signed(record: CaseRecord, event: StoredEvent) -> str:
    match event.trigger:
        case Trigger.MOVE_APPROVED:
            plan = record.artefacts[ArtefactKind.PLAN].get(event.data["plan_id"])
            return f"approved a motion: {words(plan.content['kind']) if plan is not None else NOT_TOLD}"
        case Trigger.INSERTION_STARTED:
            return "began the insertion of the sleeve"
        case _:
            return "closed the case"


def proof(record: CaseRecord) -> list[Row]:
    """Where the case's last event stands in the ledger, and what has been signed of it."""
    found = record.proof
    if found is None:
        return [
            ["Ledger", "no entry here: the case was imported, and its archive holds the ledger that vouches for it"]
        ]
    entry = [["Entry of the last event", str(found.sequence)], ["SHA-256 of the entry", found.sha256]]
    return [*entry, *_checkpoint(found.checkpoint)]


def _checkpoint(signed: Json | None) -> list[Row]:
    if signed is None:
        return [["Signature", "none yet: no checkpoint covers the last event"]]
    stated: dict[str, Any] = dict(signed)
    return [
        ["Signed checkpoint", f"entry {stated['sequence']}, {moment(stated['signed_at'])} UTC"],
        ["SHA-256 at the checkpoint", stated["sha256"]],
        ["Key (SHA-256, Ed25519)", stated["key"]],
    ]
