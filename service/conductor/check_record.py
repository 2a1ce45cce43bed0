"""The daily check in the record: an audit event, and how old the newest one is."""

from collections.abc import Sequence
from dataclasses import asdict
from datetime import UTC, datetime

import sqlalchemy as sa
from pydantic import BaseModel
from sqlalchemy.engine import Connection

from service.audit import record_audit
from service.conductor.check_items import CheckItem
from service.database import tables

_KIND = "daily_check"


class LastDailyCheck(BaseModel):
    """The newest check that was finished; its age by the wall clock, in hours."""

    passed: bool
    at: str
    age_h: float
    user_id: str | None
    failed: list[str]


def record_check(
    connection: Connection, user_id: str, items: Sequence[CheckItem], passed: bool, image_id: str | None
) -> None:
    """Add the result of a check."""
    data = {"passed": passed, "image_id": image_id, "items": [asdict(one) for one in items]}
    record_audit(connection, _KIND, user_id, data)


def last_check(connection: Connection) -> LastDailyCheck | None:
    """The newest check, passed or not; None before the first."""
    events = tables.audit_events
    query = sa.select(events).where(events.c.kind == _KIND).order_by(events.c.id.desc()).limit(1)
    row = connection.execute(query).first()
    if row is None:
        return None
    age_s = (datetime.now(UTC) - datetime.fromisoformat(row.recorded_at)).total_seconds()
    failed = [one["code"] for one in row.data["items"] if not one["passed"]]
    return LastDailyCheck(
        passed=row.data["passed"], at=row.recorded_at, age_h=age_s / 3600.0, user_id=row.user_id, failed=failed
    )
