"""The event store: a case is its events, and unique (case, sequence) is the optimistic lock.

Write transactions never overlap (engines.py), so the version read here is still the newest when the event is added;
the unique key is the proof of it, not the means.

Every function takes the connection of the caller's transaction, so that an event, its artefacts, the attempt and the
idempotency key commit together or not at all.
"""

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.cases.records import (
    ArtefactKind,
    NewArtefact,
    NewCase,
    NewEvent,
    StoredArtefact,
    StoredCase,
    StoredEvent,
)
from service.database import tables
from service.database.clock import now_utc
from service.errors import ErrorCode, ServiceError
from service.ledger.draft import describe, draft_of
from service.ledger.rows import add_rows
from service.version import PRODUCT_VERSION

_EVENT = (
    "case_id",
    "sequence",
    "version",
    "trigger",
    "user_id",
    "state",
    "case_state",
    "data",
    "recorded_at",
)
_ARTEFACT = ("id", "case_id", "sequence", "made_from", "content", "recorded_at")
_OVER = ("closed", "aborted")

# Asked at every command: put together once, for SQLAlchemy takes several times longer over that than SQLite to answer.
_OF_CASE = tables.events.c.case_id == sa.bindparam("case_id")
_NEWEST_EVENT = sa.select(tables.events).where(_OF_CASE).order_by(tables.events.c.sequence.desc()).limit(1)
_EVENTS_AFTER = (
    sa.select(tables.events)
    .where(_OF_CASE, tables.events.c.sequence > sa.bindparam("sequence"))
    .order_by(tables.events.c.sequence)
    .limit(sa.bindparam("limit"))
)
_CASE = sa.select(tables.cases).where(tables.cases.c.id == sa.bindparam("id"))
_PLANNED_TARGETS = sa.select(tables.planned_targets).where(tables.planned_targets.c.case_id == sa.bindparam("case_id"))

# Constants in the query's text, for else the index of the events that end a case is not used.
_ENDED = tables.events.c.state.in_(sa.bindparam("over", _OVER, expanding=True, literal_execute=True))
# What is over stays so; in order, so that SQLite walks both indexes side by side: 1.5 ms for 10,000 cases.
_OPEN_CASE = sa.except_(
    sa.select(tables.cases.c.id).where(tables.cases.c.room == sa.bindparam("room")),
    sa.select(tables.events.c.case_id).where(_ENDED),
).order_by(sa.text("1"))


def open_case(connection: Connection, case: NewCase, event: NewEvent) -> StoredEvent:
    """Record a new case with its first event (sequence 1); ServiceError CASE_OPEN if the room has an open one."""
    open_id = open_case_of(connection, case.room)
    if open_id is not None:
        raise ServiceError(ErrorCode.CASE_OPEN, f"room {case.room} has the open case {open_id}")
    values = {
        "id": case.id,
        "room": case.room,
        "patient_id": case.patient_id,
        "study_uid": case.study_uid,
        "opened_by": case.opened_by,
        "product_version": PRODUCT_VERSION,
        "settings_sha256": case.settings_sha256,
        "devices": dict(case.devices),
        "opened_at": now_utc(),
    }
    add_rows(connection, tables.cases, [values])
    plans = [{"case_id": case.id, "name": name, "content": dict(plan)} for name, plan in case.planned_targets.items()]
    if plans:
        add_rows(connection, tables.planned_targets, plans)
    return _insert_event(connection, case.id, event, None, sequence=1, version=1)


def append(
    connection: Connection,
    case_id: str,
    event: NewEvent,
    *,
    expected_version: int | None,
    artefacts: Sequence[NewArtefact] = (),
) -> StoredEvent:
    """Append an event and what it made.

    `expected_version` is the one the decision was made on (If-Match); None for facts and observations, which are
    never refused. Raises ServiceError CASE_UNKNOWN or VERSION_STALE.
    """
    last = newest_event(connection, case_id)
    if expected_version is not None and last.version != expected_version:
        raise ServiceError(
            ErrorCode.VERSION_STALE,
            "the case has changed since it was read",
            measured=last.version,
            limit=expected_version,
        )
    sequence = last.sequence + 1
    version = sequence if event.changes_state else last.version
    stored = _insert_event(connection, case_id, event, last.state, sequence=sequence, version=version)
    for artefact in artefacts:
        _insert_artefact(connection, stored, artefact)
    return stored


def newest_event(connection: Connection, case_id: str) -> StoredEvent:
    """The last event, which carries the case's state and version; ServiceError CASE_UNKNOWN."""
    row = connection.execute(_NEWEST_EVENT, {"case_id": case_id}).first()
    if row is None:
        raise ServiceError(ErrorCode.CASE_UNKNOWN, f"there is no case {case_id}")
    return _event(row)


def standings(connection: Connection, case_ids: Sequence[str]) -> dict[str, dict[str, Any]]:
    """State, version and sequence of each case, by its id."""
    events = tables.events.c
    newest = sa.select(events.case_id, sa.func.max(events.sequence)).where(events.case_id.in_(case_ids))
    is_newest = sa.tuple_(events.case_id, events.sequence).in_(newest.group_by(events.case_id))
    rows = connection.execute(sa.select(events.case_id, events.state, events.version, events.sequence).where(is_newest))
    return {row.case_id: {"state": row.state, "version": row.version, "sequence": row.sequence} for row in rows}


def ends(connection: Connection, case_ids: Sequence[str]) -> dict[str, str]:
    """When each case that is over was closed or aborted, by its id; what was noted later does not count."""
    events = tables.events.c
    query = sa.select(events.case_id, sa.func.min(events.sequence)).where(events.case_id.in_(case_ids), _ENDED)
    is_end = sa.tuple_(events.case_id, events.sequence).in_(query.group_by(events.case_id))
    return {row.case_id: row.recorded_at for row in connection.execute(sa.select(tables.events).where(is_end))}


def newest_sequence(connection: Connection, case_id: str) -> int:
    """The number of the last event; 0 where there is none."""
    query = sa.select(sa.func.max(tables.events.c.sequence)).where(tables.events.c.case_id == case_id)
    return connection.execute(query).scalar() or 0


def events_after(connection: Connection, case_id: str, sequence: int = 0, limit: int = 1000) -> list[StoredEvent]:
    """The events behind `sequence`, oldest first."""
    wanted = {"case_id": case_id, "sequence": sequence, "limit": limit}
    return [_event(row) for row in connection.execute(_EVENTS_AFTER, wanted)]


def events_of_kind(connection: Connection, case_id: str, triggers: Sequence[str]) -> list[StoredEvent]:
    """Every event of a case with one of these triggers, oldest first."""
    events = tables.events
    query = sa.select(events).where(events.c.case_id == case_id, events.c.trigger.in_(triggers))
    return [_event(row) for row in connection.execute(query.order_by(events.c.sequence))]


def all_events(connection: Connection, case_id: str) -> Iterator[StoredEvent]:
    """Every event of a case, oldest first."""
    events = events_after(connection, case_id)
    while events:
        yield from events
        events = events_after(connection, case_id, events[-1].sequence)


def read_case(connection: Connection, case_id: str) -> StoredCase:
    """What was fixed when the case was opened; ServiceError CASE_UNKNOWN."""
    row = connection.execute(_CASE, {"id": case_id}).first()
    if row is None:
        raise ServiceError(ErrorCode.CASE_UNKNOWN, f"there is no case {case_id}")
    return StoredCase(**row._mapping)


def whole_id(connection: Connection, beginning: str) -> str:
    """The id of the only case that begins so, and what was told where none does.

    ServiceError CASE_UNKNOWN where it is not clear which is meant.
    """
    begins = sa.func.substr(tables.cases.c.id, 1, len(beginning)) == beginning
    found = connection.execute(sa.select(tables.cases.c.id).where(begins)).scalars().all() if beginning else []
    if len(found) > 1 and beginning not in found:
        raise ServiceError(
            ErrorCode.CASE_UNKNOWN, f"several cases begin with {beginning}", measured=len(found), limit=1
        )
    return found[0] if len(found) == 1 else beginning


def list_cases(connection: Connection, limit: int | None = None, before: str | None = None) -> list[StoredCase]:
    """Cases, newest first: all, or so many of those before one; ServiceError CASE_UNKNOWN."""
    cases = tables.cases
    query = sa.select(cases).order_by(cases.c.opened_at.desc(), cases.c.id.desc()).limit(limit)
    if before is not None:
        last = read_case(connection, before)
        query = query.where(sa.tuple_(cases.c.opened_at, cases.c.id) < sa.tuple_(last.opened_at, last.id))
    return [StoredCase(**row._mapping) for row in connection.execute(query)]


def planned_targets(connection: Connection, case_id: str) -> dict[str, Any]:
    """The planned targets of a case, by name."""
    return {row.name: row.content for row in connection.execute(_PLANNED_TARGETS, {"case_id": case_id})}


def open_case_of(connection: Connection, room: str) -> str | None:
    """The id of the room's case that is neither closed nor aborted, if there is one."""
    return connection.execute(_OPEN_CASE, {"room": room}).scalar()


@cache
def _artefact_of(kind: ArtefactKind) -> sa.Select[Any]:
    table = tables.metadata.tables[kind]
    return sa.select(table).where(table.c.id == sa.bindparam("id"))


def read_artefact(connection: Connection, kind: ArtefactKind, artefact_id: str) -> StoredArtefact:
    """One artefact; ServiceError ARTEFACT_UNKNOWN."""
    row = connection.execute(_artefact_of(kind), {"id": artefact_id}).first()
    if row is None:
        raise ServiceError(ErrorCode.ARTEFACT_UNKNOWN, f"there is no row {artefact_id} in {kind}")
    return _artefact(row)


def artefacts_of(connection: Connection, kind: ArtefactKind, case_id: str) -> list[StoredArtefact]:
    """Every artefact of one kind in a case, oldest first."""
    table = tables.metadata.tables[kind]
    query = sa.select(table).where(table.c.case_id == case_id).order_by(table.c.sequence)
    return [_artefact(row) for row in connection.execute(query)]


def _insert_event(
    connection: Connection, case_id: str, event: NewEvent, before: str | None, *, sequence: int, version: int
) -> StoredEvent:
    stored = StoredEvent(
        case_id=case_id,
        sequence=sequence,
        version=version,
        trigger=event.trigger,
        user_id=event.user_id,
        state=event.state,
        case_state=dict(event.case_state),
        data=dict(event.data),
        recorded_at=now_utc(),
    )
    add_rows(connection, tables.events, [{name: getattr(stored, name) for name in _EVENT}])
    describe(connection, action=event.trigger, actor=event.user_id, case_id=case_id, before=before, after=event.state)
    return stored


def _insert_artefact(connection: Connection, event: StoredEvent, artefact: NewArtefact) -> None:
    values = {
        "id": artefact.id,
        "case_id": event.case_id,
        "sequence": event.sequence,
        "made_from": list(artefact.made_from),
        "content": dict(artefact.content),
        "recorded_at": event.recorded_at,
        **artefact.columns,
    }
    add_rows(connection, tables.metadata.tables[artefact.kind], [values])
    draft_of(connection).artefacts.append(artefact.id)


def _event(row: sa.Row[Any]) -> StoredEvent:
    return StoredEvent(**{name: row._mapping[name] for name in _EVENT})


def _artefact(row: sa.Row[Any]) -> StoredArtefact:
    fields = {name: row._mapping[name] for name in _ARTEFACT} | {"made_from": tuple(row.made_from)}
    return StoredArtefact(**fields, columns={k: v for k, v in row._mapping.items() if k not in _ARTEFACT})
