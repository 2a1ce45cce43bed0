"""The part of the ledger that vouches for a case: entries from the one that is needed to the signature behind it.

Entries of other cases may lie between; they hold hashes, and who did what, but nothing of a patient.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.archive.contents import IMPORTED, Row, Rows
from service.database import tables
from service.ledger.beginning import TAKEN_IN

# What entries are called that add an image or a device file.
_STORING = ("image_stored", "device_stored", "device_uploaded", "recorded", TAKEN_IN, IMPORTED)
_LEDGER, _CHECKPOINTS = tables.ledger.c, tables.checkpoints.c


@dataclass(frozen=True, slots=True)
class Proof:
    """Entries in unbroken runs, each ending in a checkpoint, and these checkpoints."""

    entries: list[Row]
    checkpoints: list[Row]


def proof_of(connection: Connection, case_id: str, rows: Rows) -> Proof:
    """What proves the rows of a case."""
    needed = sorted(_needed(connection, case_id, rows))
    entries: list[Row] = []
    checkpoints: list[Row] = []
    for first, last in _runs(connection, needed):
        chosen = sa.select(_LEDGER.sequence, _LEDGER.sha256, _LEDGER.entry).where(_LEDGER.sequence.between(first, last))
        entries += [dict(row) for row in connection.execute(chosen.order_by(_LEDGER.sequence)).mappings()]
        signed = sa.select(tables.checkpoints).where(_CHECKPOINTS.sequence == last)
        checkpoints += [dict(row) for row in connection.execute(signed).mappings()]
    return Proof(entries, checkpoints)


def _needed(connection: Connection, case_id: str, rows: Rows) -> set[int]:
    """The entries of the case, and those of images and device files, which came before it or beside it."""
    needed = set(connection.execute(sa.select(_LEDGER.sequence).where(_LEDGER.case_id == case_id)).scalars())
    for name in ("images", "device_files"):
        for row in rows[name]:
            needed |= set(_vouching(connection, name, row["id"]))
    return needed


def _vouching(connection: Connection, name: str, row_id: str) -> Iterator[int]:
    named = _LEDGER.action.in_(_STORING) & _LEDGER.entry.contains(row_id, autoescape=True)
    for sequence, entry in connection.execute(sa.select(_LEDGER.sequence, _LEDGER.entry).where(named)):
        if any(key == [row_id] for key, _ in json.loads(entry)["rows"].get(name, [])):
            yield sequence


def _runs(connection: Connection, needed: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Runs of entries, each from a needed one to the first checkpoint at or behind it."""
    last = 0
    for sequence in needed:
        if sequence > last:
            behind = sa.select(sa.func.min(_CHECKPOINTS.sequence)).where(_CHECKPOINTS.sequence >= sequence)
            last = connection.execute(behind).scalar_one() or sequence
            yield sequence, last
