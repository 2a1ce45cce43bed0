"""Every request that was decided, with the verdict of every interlock: what the audit and `/interlocks` show."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.cases.records import NewAttempt
from service.database import tables
from service.database.clock import now_utc
from service.ledger.draft import describe
from service.ledger.rows import add_rows

_ATTEMPT = ("case_id", "user_id", "trigger", "accepted", "code", "message", "state")
_VERDICT = ("code", "hazard", "passed", "measured", "limit", "unit", "message")


def record_attempt(connection: Connection, attempt: NewAttempt) -> int:
    """Store an attempt with its verdicts; the number it got."""
    values = {name: getattr(attempt, name) for name in _ATTEMPT} | {"recorded_at": now_utc()}
    number = int(add_rows(connection, tables.attempts, [values])[0]["id"])
    rows = [
        {"attempt_id": number} | {name: getattr(verdict, name) for name in _VERDICT} for verdict in attempt.verdicts
    ]
    if rows:
        add_rows(connection, tables.verdicts, rows)
    describe(
        connection,
        action=attempt.trigger,
        actor=attempt.user_id,
        case_id=attempt.case_id,
        before=attempt.state,
        attempt_id=number,
        payload={
            "accepted": attempt.accepted,
            "code": attempt.code,
            "message": attempt.message,
            "refused_by": [verdict.code for verdict in attempt.verdicts if not verdict.passed],
        },
    )
    return number


def list_attempts(connection: Connection, case_id: str | None, limit: int = 200) -> list[dict[str, Any]]:
    """The newest attempts of a case (of all, if None), newest first, each with its verdicts."""
    table = tables.attempts
    query = sa.select(table).order_by(table.c.id.desc()).limit(limit)
    if case_id is not None:
        query = query.where(table.c.case_id == case_id)
    found = [dict(row._mapping) for row in connection.execute(query)]
    verdicts = _verdicts(connection, [attempt["id"] for attempt in found])
    return [attempt | {"verdicts": verdicts[attempt["id"]]} for attempt in found]


def _verdicts(connection: Connection, attempts: Sequence[int]) -> Mapping[int, list[dict[str, Any]]]:
    """The verdicts of each attempt, in the order in which they were given."""
    table, found = tables.verdicts, defaultdict[int, list[dict[str, Any]]](list)
    columns = [table.c[name] for name in _VERDICT]
    query = sa.select(table.c.attempt_id, *columns).where(table.c.attempt_id.in_(attempts)).order_by(table.c.id)
    for attempt_id, *values in connection.execute(query):
        found[attempt_id].append(dict(zip(_VERDICT, values, strict=True)))
    return found
