"""The whole verification: the file, the schema, entries and rows, checkpoints, anchor; nothing is written."""

from collections.abc import Callable, Mapping
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.database.engines import Database
from service.ledger.anchor_check import anchored_entry, check_anchor
from service.ledger.checkpoint_check import check_checkpoints, due_by_count
from service.ledger.findings import Finding, Verification
from service.ledger.keys import Verifier
from service.ledger.parts_check import check_parts, read_all
from service.ledger.schema_check import check_schema
from service.ledger.unvouched import find_unvouched

Progress = Callable[[int], None]


def verify(
    database: Database,
    verifiers: Mapping[str, Verifier],
    anchor_file: Path,
    workers: int = 1,
    progress: Progress = lambda _: None,
) -> Verification:
    """Look at everything and find what is not as it was recorded."""
    # Read before the database is looked at, which then holds at least that entry, however much is written meanwhile.
    anchored = anchored_entry(anchor_file, verifiers)

    def check(connection: Connection, verification: Verification) -> None:
        _check_file(connection, verification)
        check_schema(connection, verification)
        newest = connection.execute(sa.select(sa.func.max(tables.ledger.c.sequence))).scalar() or 0
        if newest == 0:
            verification.find("ledger", "there are no entries: deleted")
        for part in check_parts(database, newest, workers):
            verification.add(part)
            progress(verification.entries)
        find_unvouched(connection, verification, newest)
        due = [*verification.closings, *due_by_count(newest)]
        check_checkpoints(connection, verification, verifiers, due)
        if isinstance(anchored, Finding):
            verification.findings.append(anchored)
        else:
            verification.anchored = anchored.sequence
            check_anchor(connection, verification, anchored)

    return read_all(database, check)


def _check_file(connection: Connection, verification: Verification) -> None:
    """The structure below the rows: SQLite's own check of pages and indices."""
    if connection.dialect.name != "sqlite":
        return
    for line in connection.execute(sa.text("PRAGMA integrity_check(20)")).scalars():
        if line != "ok":
            verification.find("database file", line)
