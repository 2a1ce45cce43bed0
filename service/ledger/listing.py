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
    first, last = _bounds(connection, wanted)
    after, conditions = max(after, first - 1), _conditions(connection, wanted)
    query = sa.select(_LEDGER.entry, _LEDGER.sha256).where(_LEDGER.sequence > after)
    if last is not None:
        query = query.where(_LEDGER.sequence < last)
    if wanted.interlock is not None or wanted.hazard is not None:
        conditions.append(_judged(connection, wanted, None if conditions else (after, limit)))
    rows = connection.execute(query.where(*conditions).order_by(_LEDGER.sequence).limit(limit))
    return [json.loads(row.entry) | {"sha256": row.sha256} for row in rows]


def _conditions(connection: Connection, wanted: Wanted) -> list[sa.ColumnElement[bool]]:
    asked = {"case_id": wanted.case_id, "actor": _actor(connection, wanted.actor), "action": wanted.action}
    return [_LEDGER[name] == value for name, value in asked.items() if value is not None]


def _actor(connection: Connection, name: str | None) -> str | None:
    users = tables.users.c
    found = connection.execute(sa.select(users.id).where(users.name == name)).scalar() if name else None
    return found or name


def _judged(connection: Connection, wanted: Wanted, place: tuple[int, int] | None) -> sa.ColumnElement[bool]:
    """Entries whose attempt has such a verdict; those of one page alone where nothing else narrows them down.

    Attempts are numbered in the order of their entries, so that the index of verdicts yields a page at once.
    """
    gave = [_VERDICTS.code == wanted.interlock] if wanted.interlock is not None else []
    gave += [_VERDICTS.hazard == wanted.hazard] if wanted.hazard is not None else []
    if place is None:
        return sa.exists().where(_VERDICTS.attempt_id == _LEDGER.attempt_id, *gave)
    after, limit = place
    earlier = sa.select(_LEDGER.attempt_id).where(_LEDGER.sequence <= after, _LEDGER.attempt_id.is_not(None))
    passed = connection.execute(earlier.order_by(_LEDGER.sequence.desc()).limit(1)).scalar() or 0
    judged = sa.select(_VERDICTS.attempt_id).where(_VERDICTS.attempt_id > passed, *gave).distinct()
    return _LEDGER.attempt_id.in_(judged.order_by(_VERDICTS.attempt_id).limit(limit))


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
