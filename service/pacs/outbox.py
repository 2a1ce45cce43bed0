"""What is to be sent and what became of it: rows that are only added, so that a restart sends what is left."""

from collections.abc import Sequence
from dataclasses import dataclass

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.archive.contents import IMPORTED
from service.database import tables
from service.database.clock import now_utc
from service.images.store import keep_bytes, kept_bytes
from service.ledger.draft import describe
from service.ledger.rows import add_rows
from service.pacs.derived import DerivedObject

_OVER = ("closed", "aborted")


@dataclass(frozen=True, slots=True)
class QueuedObject:
    """An object of the outbox without its bytes; `answer` is the archive's newest, None before the first."""

    id: str
    case_id: str
    kind: str
    sop_class: str
    sha256: str
    queued_at: str
    delivered: bool
    answer: str | None


def queue(connection: Connection, case_id: str, objects: Sequence[DerivedObject]) -> None:
    """Queue a case's objects, all of them or none."""
    for one in objects:
        row = {
            "id": one.sop_uid,
            "case_id": case_id,
            "kind": one.kind,
            "sop_class": one.sop_class,
            "sha256": keep_bytes(connection, one.content),
            "queued_at": now_utc(),
        }
        add_rows(connection, tables.outgoing_objects, [row])
    describe(
        connection, action="objects_queued", case_id=case_id, payload={"objects": [one.sop_uid for one in objects]}
    )


def cases_to_prepare(connection: Connection, room: str) -> list[str]:
    """The room's own cases that are over and have nothing in the outbox yet, oldest first; no imported ones."""
    cases, events, outgoing, ledger = tables.cases, tables.events, tables.outgoing_objects, tables.ledger
    over = sa.exists().where(events.c.case_id == cases.c.id, events.c.state.in_(_OVER))
    queued = sa.exists().where(outgoing.c.case_id == cases.c.id)
    imported = sa.exists().where(ledger.c.case_id == cases.c.id, ledger.c.action == IMPORTED)
    query = sa.select(cases.c.id).where(cases.c.room == room, over, ~queued, ~imported).order_by(cases.c.opened_at)
    return list(connection.execute(query).scalars())


def undelivered(connection: Connection) -> list[QueuedObject]:
    """What no archive has accepted yet, oldest first."""
    return [one for one in _objects(connection, None) if not one.delivered]


def count_undelivered(connection: Connection) -> int:
    """How many no archive has accepted yet."""
    outgoing, deliveries = tables.outgoing_objects, tables.deliveries
    accepted = sa.exists().where(deliveries.c.object_id == outgoing.c.id, deliveries.c.accepted)
    return connection.scalar(sa.select(sa.func.count()).select_from(outgoing).where(~accepted)) or 0


def objects_of(connection: Connection, case_id: str) -> list[QueuedObject]:
    """A case's objects with what became of them."""
    return _objects(connection, case_id)


def content_of(connection: Connection, queued: QueuedObject) -> bytes:
    """The DICOM file."""
    return kept_bytes(connection, queued.sha256)


def record_delivery(connection: Connection, queued: QueuedObject, answer: str, *, accepted: bool) -> None:
    """Record the archive's answer; one that repeats the last is no news, however often it is tried."""
    if answer == queued.answer:
        return
    row = {"object_id": queued.id, "accepted": accepted, "answer": answer, "recorded_at": now_utc()}
    add_rows(connection, tables.deliveries, [row])
    action = "object_delivered" if accepted else "object_not_delivered"
    describe(connection, action=action, case_id=queued.case_id, payload={"object": queued.id, "answer": answer})


def _objects(connection: Connection, case_id: str | None) -> list[QueuedObject]:
    outgoing, deliveries = tables.outgoing_objects, tables.deliveries
    newest = (
        sa.select(deliveries.c.object_id, sa.func.max(deliveries.c.id).label("id")).group_by(deliveries.c.object_id)
    ).subquery()
    query = (
        sa.select(outgoing, deliveries.c.accepted, deliveries.c.answer)
        .outerjoin(newest, newest.c.object_id == outgoing.c.id)
        .outerjoin(deliveries, deliveries.c.id == newest.c.id)
        .order_by(outgoing.c.queued_at, outgoing.c.id)
    )
    if case_id is not None:
        query = query.where(outgoing.c.case_id == case_id)
    return [_queued(row) for row in connection.execute(query)]


def _queued(row: sa.Row[tuple[object, ...]]) -> QueuedObject:
    stored = {name: row._mapping[name] for name in ("id", "case_id", "kind", "sop_class", "sha256", "queued_at")}
    return QueuedObject(**stored, delivered=bool(row.accepted), answer=row.answer)
