"""What an archive of a case holds: record rows as they are stored, the bytes that they name, the people in them."""

import hashlib
import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.cases import store
from service.database import tables
from service.images.findings import FINDINGS
from service.ledger.rows import stored_columns
from workflow.triggers import Trigger

IMPORTED = "case_imported"  # the action under which a case from another machine enters the ledger
Row = dict[str, Any]
Rows = dict[str, list[Row]]

# Bytes stand in no table of an archive: their own hash names them, wherever they are named.
ARCHIVED: tuple[sa.Table, ...] = tuple(
    table for table in tables.RECORDS if table.name not in ("image_bytes", "audit_events")
)
_OF_CASE = tuple(table for table in ARCHIVED if "case_id" in table.columns)


@dataclass(slots=True)
class Contents:
    """Rows by table, in the order of their keys; bytes by SHA-256; users by id with name and role."""

    rows: Rows
    files: dict[str, bytes]
    users: dict[str, dict[str, str]]


def contents_of(connection: Connection, case_id: str) -> Contents:
    """Everything that the record has of a case; ServiceError CASE_UNKNOWN."""
    case = store.read_case(connection, case_id)
    events = list(store.all_events(connection, case_id))
    files: dict[str, bytes] = {}
    rows = {table.name: _read(connection, table, table.c.case_id == case_id, files) for table in _OF_CASE}
    rows["cases"] = _read(connection, tables.cases, tables.cases.c.id == case_id, files)
    of_case = sa.select(tables.attempts.c.id).where(tables.attempts.c.case_id == case_id)
    rows["verdicts"] = _read(connection, tables.verdicts, tables.verdicts.c.attempt_id.in_(of_case), files)
    sent = sa.select(tables.outgoing_objects.c.id).where(tables.outgoing_objects.c.case_id == case_id)
    rows["deliveries"] = _read(connection, tables.deliveries, tables.deliveries.c.object_id.in_(sent), files)
    images = {row["image_id"] for row in (*rows["image_purposes"], *rows["image_assignments"])}
    rows["images"] = _read(connection, tables.images, tables.images.c.id.in_(images), files)
    devices = set(case.devices.values())
    for event in events:
        devices |= set(event.data.get("devices", {}).values()) if event.trigger == Trigger.DEVICE_CHANGED else set()
    rows["device_files"] = _read(connection, tables.device_files, tables.device_files.c.id.in_(devices), files)
    named = {row["sha256"] for row in (*rows["images"], *rows["outgoing_objects"])} | {case.settings_sha256}
    named |= {event.data[FINDINGS] for event in events if FINDINGS in event.data}
    files |= _kept(connection, named)
    return Contents({name: rows[name] for name in sorted(rows)}, files, _users(connection, rows))


def _read(connection: Connection, table: sa.Table, condition: Any, files: dict[str, bytes]) -> list[Row]:
    query = sa.select(*stored_columns(table, connection.dialect.name)).where(condition)
    found = connection.execute(query.order_by(*table.primary_key.columns)).mappings()
    return [{name: _named(value, files) for name, value in row.items()} for row in found]


def _named(value: Any, files: dict[str, bytes]) -> Any:
    """Bytes by their hash, as the ledger has them too."""
    if not isinstance(value, bytes | memoryview):
        return value
    sha256 = hashlib.sha256(value).hexdigest()
    files[sha256] = bytes(value)
    return {"sha256": sha256}


def _kept(connection: Connection, names: Iterable[str]) -> dict[str, bytes]:
    kept = tables.image_bytes
    rows = connection.execute(sa.select(kept).where(kept.c.sha256.in_(sorted(names))))
    return {row.sha256: bytes(row.content) for row in rows}


def _users(connection: Connection, rows: Rows) -> dict[str, dict[str, str]]:
    users, ids = tables.users, {user_id for user_id in _user_ids(rows) if user_id is not None}
    found = connection.execute(sa.select(users.c.id, users.c.name, users.c.role).where(users.c.id.in_(sorted(ids))))
    return {row.id: {"name": row.name, "role": row.role} for row in found.all()}


def _user_ids(rows: Rows) -> Iterator[str | None]:
    for name, some in rows.items():
        refer = [
            key.parent.name for key in tables.metadata.tables[name].foreign_keys if key.column.table is tables.users
        ]
        for row in some:
            yield from (row[column] for column in refer)
            yield row.get("user_id")


def line(value: Any) -> bytes:
    """A value as one line of JSON, always the same for the same value."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode() + b"\n"
