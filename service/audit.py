"""Audit events that belong to no case: sign-ins, wrong answers, device files, readings. Rows, not logs."""

from collections.abc import Mapping
from typing import Any

from sqlalchemy.engine import Connection

from service.database import tables
from service.database.clock import now_utc
from service.database.engines import Database
from service.ledger.draft import describe
from service.ledger.rows import add_rows


def record_audit(connection: Connection, kind: str, user_id: str | None, data: Mapping[str, Any]) -> None:
    """Add an audit event in the transaction of what it tells of."""
    values = {"kind": kind, "user_id": user_id, "data": dict(data), "recorded_at": now_utc()}
    add_rows(connection, tables.audit_events, [values])
    describe(connection, action=kind, actor=user_id, payload=data)


def record_reading(database: Database, user_id: str | None, what: str, asked: Mapping[str, Any]) -> None:
    """Record that somebody reads the record, before they do."""
    with database.write() as connection:
        record_audit(connection, "log_read", user_id, {"what": what, "asked": dict(asked)})
