"""The ledger as it is read: by case, actor, action, interlock, hazard and time, in pages, by sequence."""

import json
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables

_LEDGER, _VERDICTS = tables.ledger.c, tables.verdicts.c


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which entries; what is None does not matter.

    Interlock and hazard ask for entries in which one gave a verdict. Times (UTC) are those of a clock that never goes
    back: an entry counts at the latest time that any entry up to it was written at (H23).
    """

    case_id: str | None = None
    actor: str | None = None  # name or id
    action: str | None = None
    interlock: str | None = None
    hazard: str | None = None
    since: str | None = None
    until: str | None = None


def page(connection: Connection, wanted: Wanted, after: int = 0, limit: int = 200) -> list[dict[str, Any]]:
    """Entries behind sequence `after`, oldest first, each with its hash."""
    order: sa.ColumnElement[Any] = _LEDGER.sequence
    query = sa.select(_LEDGER.entry, _LEDGER.sha256).where(*_conditions(connection, wanted))
    if wanted.interlock is not None or wanted.hazard is not None:
        query, order = _by_verdicts(connection, query, wanted, after)
    first, last = _bounds(connection, wanted)
    query = query.where(_LEDGER.sequence > max(after, first - 1))
    if last is not None:
        query = query.where(_LEDGER.sequence < last)
    rows = connection.execute(query.order_by(order).limit(limit))
    return [json.loads(row.entry) | {"sha256": row.sha256} for row in rows]


def _conditions(connection: Connection, wanted: Wanted) -> list[sa.ColumnElement[bool]]:
    asked = {"case_id": wanted.case_id, "actor": _actor(connection, wanted.actor), "action": wanted.action}
    return [_LEDGER[name] == value for name, value in asked.items() if value is not None]


def _actor(connection: Connection, name: str | None) -> str | None:
    users = tables.users.c
    found = connection.execute(sa.select(users.id).where(users.name == name)).scalar() if name else None
    return found or name


def _by_verdicts(
    connection: Connection, query: sa.Select[Any], wanted: Wanted, after: int
) -> tuple[sa.Select[Any], sa.ColumnElement[Any]]:
    """Through the index of verdicts: attempts are numbered in the order of their entries."""
    earlier = sa.select(_LEDGER.attempt_id).where(_LEDGER.sequence <= after, _LEDGER.attempt_id.is_not(None))
    passed = connection.execute(earlier.order_by(_LEDGER.sequence.desc()).limit(1)).scalar() or 0
    gave = [_VERDICTS.attempt_id > passed]
    gave += [_VERDICTS.code == wanted.interlock] if wanted.interlock is not None else []
    gave += [_VERDICTS.hazard == wanted.hazard] if wanted.hazard is not None else []
    judged = sa.select(_VERDICTS.attempt_id).where(*gave).distinct().subquery()
    joined = query.join_from(judged, tables.ledger, _LEDGER.attempt_id == judged.c.attempt_id)
    return joined, judged.c.attempt_id


def _bounds(connection: Connection, wanted: Wanted) -> tuple[int, int | None]:
    """The first entry of the time asked for, and the first behind it; one behind the newest where there is none."""
    first = _first_at(connection, wanted.since) if wanted.since is not None else 1
    return first, None if wanted.until is None else _first_at(connection, wanted.until)


def _first_at(connection: Connection, time: str) -> int:
    query = sa.select(_LEDGER.sequence).where(_LEDGER.reached_at >= time)
    found = connection.execute(query.order_by(_LEDGER.reached_at, _LEDGER.sequence).limit(1)).scalar()
    if found is not None:
        return int(found)
    return 1 + (connection.execute(sa.select(sa.func.max(_LEDGER.sequence))).scalar() or 0)
