"""An entry of the ledger: one JSON text (RFC 8785) that names the hash of the one before it."""

import hashlib
import time
from dataclasses import dataclass
from typing import Any
from uuid import uuid4

import rfc8785
import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.database.clock import now_utc
from service.database.json_text import portable
from service.errors import ErrorCode, ServiceError
from service.ledger.draft import Draft
from service.ledger.rows import digest
from service.ledger.speaker import SPEAKER

# The monotonic clock means something only within one run of one process.
_RUN = uuid4().hex
NOTHING_BEFORE = "0" * 64
# What the columns repeat of the text, by their common name.
REPEATED = ("case_id", "actor", "action", "attempt_id")
_NEWEST = (
    sa.select(tables.ledger.c.sequence, tables.ledger.c.sha256, tables.ledger.c.reached_at)
    .order_by(tables.ledger.c.sequence.desc())
    .limit(1)
)
_NAME_AND_ROLE = sa.select(tables.users.c.name, tables.users.c.role).where(tables.users.c.id == sa.bindparam("id"))


@dataclass(frozen=True, slots=True)
class Head:
    """The newest entry: its number, its hash, and the latest wall time that any entry has reached."""

    sequence: int
    sha256: str
    reached_at: str


BEFORE_THE_FIRST = Head(0, NOTHING_BEFORE, "")


def head_of(connection: Connection) -> Head:
    """The newest entry; ServiceError LEDGER_BROKEN where there is none, for a schema comes with its first."""
    row = connection.execute(_NEWEST).first()
    if row is None:
        raise ServiceError(ErrorCode.LEDGER_BROKEN, "the ledger has no entries")
    return Head(*row)


def append_entry(connection: Connection, draft: Draft, before: Head) -> Head:
    """Write the entry of a draft behind `before`."""
    recorded_at = now_utc()
    said = _said(connection, draft) | {
        "sequence": before.sequence + 1,
        "previous": before.sha256,
        "recorded_at": recorded_at,
    }
    text = rfc8785.dumps(portable(said)).decode()
    head = Head(before.sequence + 1, sha256_of(text), max(before.reached_at, recorded_at))
    repeated = {name: said[name] for name in REPEATED}
    values = {"sequence": head.sequence, "sha256": head.sha256, "reached_at": head.reached_at, "entry": text}
    connection.execute(sa.insert(tables.ledger), values | repeated)
    return head


def sha256_of(text: str) -> str:
    """The hash of an entry's text."""
    return hashlib.sha256(text.encode()).hexdigest()


def _said(connection: Connection, draft: Draft) -> dict[str, Any]:
    name, role = _name_and_role(connection, draft.actor)
    return {
        "run": _RUN,
        "monotonic_us": time.monotonic_ns() // 1000,  # microseconds: nanoseconds leave JSON's integers after 104 days
        "actor": draft.actor,
        "actor_name": name,
        "role": role,
        "client": SPEAKER.get(),
        "action": draft.action or "recorded",
        "case_id": draft.case_id,
        "before": draft.before,
        "after": draft.after,
        "attempt_id": draft.attempt_id,
        "artefacts": draft.artefacts,
        "payload": draft.payload,
        "rows": {
            table.name: [[list(key), digest(table, rows)] for key, rows in covered.items()]
            for table, covered in draft.covered.items()
        },
    }


def _name_and_role(connection: Connection, actor: str | None) -> tuple[str | None, str | None]:
    if actor is None:
        return None, None
    row = connection.execute(_NAME_AND_ROLE, {"id": actor}).first()
    return (None, None) if row is None else (row.name, row.role)
