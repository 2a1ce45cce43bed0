"""One decision in one transaction: read the case, measure, ask the rules, append what follows with every verdict."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from sqlalchemy.engine import Connection

from service.auth.lease import Lease, lease_of
from service.cases import store
from service.cases.attempts import record_attempt
from service.cases.records import NewArtefact, NewAttempt, NewEvent, StoredCase, StoredEvent
from service.conductor.configuration import configuration_of
from service.conductor.device_set import DeviceSet, changed_devices, read_devices
from service.conductor.snapshots import Held, measure
from service.conductor.unusable import why_unusable
from service.conductor.verdict_json import kept_verdict, verdict_json
from service.errors import ErrorCode, ServiceError
from service.ledger.draft import describe
from service.motion.arm_watch import ArmWatch
from workflow.case import CaseState
from workflow.case_json import from_json, to_json
from workflow.decisions import Decision, Effect
from workflow.facts import Facts
from workflow.interlocks import GOES_FURTHER, REQUIRED
from workflow.limits import Limits
from workflow.machine import decide
from workflow.refusals import Refusal
from workflow.snapshot import SafetySnapshot, unknown_snapshot
from workflow.triggers import Trigger

# What an interlock judges, and the status, which tells what each would say.
_MEASURED = REQUIRED.keys() | GOES_FURTHER | {Trigger.READ}


@dataclass(frozen=True, slots=True)
class Standing:
    """A case as it stands in the transaction of a decision, and the world as it was measured for it."""

    connection: Connection
    last: StoredEvent
    case: CaseState
    snapshot: SafetySnapshot
    lease: Lease | None
    read_devices: DeviceSet | None  # None for what no interlock judges

    @property
    def devices(self) -> DeviceSet:
        """The device files that a request is judged with."""
        if self.read_devices is None:
            raise AssertionError("no device file was read for what no interlock judges")
        return self.read_devices


@dataclass(frozen=True, slots=True)
class Prepared:
    """What comes with a trigger and what it makes.

    `data` goes into the event, `detail` into the answer, `then` is done once the transaction is committed; `limits` of
    the interlocks come from what was measured, beside the site's.
    """

    facts: Facts
    artefacts: tuple[NewArtefact, ...] = ()
    made: Mapping[str, str] = field(default_factory=dict)
    data: Mapping[str, Any] = field(default_factory=dict)
    detail: Mapping[str, Any] = field(default_factory=dict)
    then: Callable[[Decision], None] | None = None
    also: Callable[[Connection, Decision], None] | None = None  # rows that commit with the event
    limits: Mapping[str, Any] = field(default_factory=dict)

    def among(self, limits: Limits) -> Limits:
        """The site's limits with those that were told."""
        return replace(limits, **self.limits)


Prepare = Callable[[Standing], Prepared]


@dataclass(frozen=True, slots=True)
class Taken:
    """A decision that is in the record."""

    decision: Decision
    before: CaseState
    event: StoredEvent
    prepared: Prepared


@dataclass(frozen=True, slots=True)
class Rules:
    """What every decision needs beside the case."""

    watch: ArmWatch
    limits: Limits
    clock: Callable[[], float]
    settings_sha256: str
    room: str


def stand(connection: Connection, rules: Rules, case_id: str, trigger: Trigger) -> Standing:
    """The case and the world; ServiceError CASE_UNKNOWN, CASE_ELSEWHERE, DEVICE_REFUSED.

    Nothing is measured for what no interlock judges: a fact, a stop or a restart should not wait for a reading, nor
    fail at a device file that cannot be read any more.
    """
    opened, last = case_here(connection, rules, case_id)
    case, lease = from_json(dict(last.case_state)), lease_of(connection, case_id)
    if trigger not in _MEASURED:
        return Standing(connection, last, case, unknown_snapshot(), lease, None)
    devices = read_devices(connection, changed_devices(connection, case_id, opened.devices))
    configuration = configuration_of(opened, rules.settings_sha256, devices)
    held = Held(lease.fencing_token if lease else None, devices, configuration)
    return Standing(connection, last, case, measure(rules.watch, case, trigger, held), lease, devices)


def case_here(connection: Connection, rules: Rules, case_id: str) -> tuple[StoredCase, StoredEvent]:
    """A case of this room and its newest event; ServiceError CASE_UNKNOWN, CASE_ELSEWHERE.

    Services of several rooms share a database, and each measures and locks its own arm alone (H19).
    """
    opened = store.read_case(connection, case_id)
    if opened.room != rules.room:
        message = f"the case is in {opened.room}"
        raise ServiceError(ErrorCode.CASE_ELSEWHERE, message, measured=opened.room, limit=rules.room)
    return opened, store.newest_event(connection, case_id)


def take(
    standing: Standing, rules: Rules, trigger: Trigger, prepared: Prepared, user_id: str | None, version: int | None
) -> Taken | Refusal:
    """Decide and record, accepted or refused; ServiceError VERSION_STALE if the case is not at `version`."""
    limits = prepared.among(rules.limits)
    answer = decide(standing.case, trigger, prepared.facts, standing.snapshot, limits, rules.clock())
    record_attempt(standing.connection, _attempt(standing, trigger, answer, user_id))
    if isinstance(answer, Refusal):
        return answer
    event = store.append(
        standing.connection,
        standing.case.case_id,
        _event(standing, answer, prepared, user_id),
        expected_version=version,
        artefacts=prepared.artefacts,
    )
    if Effect.CHECKPOINT_SIGNED in answer.effects:
        describe(standing.connection, checkpoint=answer.trigger)
    if prepared.also is not None:
        prepared.also(standing.connection, answer)
    return Taken(answer, standing.case, event, prepared)


def _attempt(standing: Standing, trigger: Trigger, answer: Decision | Refusal, user_id: str | None) -> NewAttempt:
    refused = isinstance(answer, Refusal)
    return NewAttempt(
        case_id=standing.case.case_id,
        user_id=user_id,
        trigger=trigger,
        accepted=not refused,
        code=answer.code if isinstance(answer, Refusal) else answer.outcome,
        message=answer.message if isinstance(answer, Refusal) else "",
        state=standing.case.state,
        verdicts=tuple(kept_verdict(verdict_json(verdict)) for verdict in answer.verdicts),
    )


def _event(standing: Standing, decision: Decision, prepared: Prepared, user_id: str | None) -> NewEvent:
    data = {
        "told_as": decision.trigger,
        "outcome": decision.outcome,
        "row": decision.row,
        "voided": list(decision.voided),
        "effects": list(decision.effects),
        "made": dict(prepared.made),
        **prepared.data,
        **why_unusable(standing.connection, decision, prepared.data),
    }
    return NewEvent(
        trigger=decision.taken_as,
        user_id=user_id,
        state=decision.after.state,
        case_state=to_json(decision.after),
        data=data,
        changes_state=_changes(standing.case, decision.after),
    )


def _changes(before: CaseState, after: CaseState) -> bool:
    """Counting an image that enters no chain outdates nobody's decision."""
    return replace(after, images=before.images, newest_image_id=before.newest_image_id) != before
