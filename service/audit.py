"""Audit events that belong to no case: sign-ins, refusals, device files, images. Rows, not logs."""

from collections.abc import Mapping
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.database.clock import now_utc


def record_audit(connection: Connection, kind: str, user_id: str | None, data: Mapping[str, Any]) -> None:
    """Add an audit event in the transaction of what it tells of."""
    connection.execute(
        sa.insert(tables.audit_events).values(kind=kind, user_id=user_id, data=dict(data), recorded_at=now_utc())
    )


def list_audit(connection: Connection, after: int = 0, limit: int = 500) -> list[dict[str, Any]]:
    """Audit events behind number `after`, oldest first."""
    table = tables.audit_events
    query = sa.select(table).where(table.c.id > after).order_by(table.c.id).limit(limit)
    return [dict(row._mapping) for row in connection.execute(query)]
