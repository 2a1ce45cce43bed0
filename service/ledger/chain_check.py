"""Walks the ledger from one entry to another: every text has its hash, every entry follows the one before it."""

from collections.abc import Iterator
from typing import Any

import orjson
import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.ledger.entries import BEFORE_THE_FIRST, REPEATED, Head, sha256_of
from service.ledger.findings import Verification

_A_TIME = 2000
_REPEATED = ("sequence", *REPEATED)
_LEDGER = tables.ledger.c
Entry = dict[str, Any]


class ChainCheck:
    """The state between two entries: what the next must be."""

    def __init__(self, connection: Connection, verification: Verification, first: int, last: int) -> None:
        self._connection = connection
        self._verification = verification
        self._before = _before(connection, first)
        self._end = last

    def entries(self) -> Iterator[list[Entry]]:
        """The readable entries, some at a time, with what is wrong found on the way."""
        columns = [_LEDGER[name] for name in (*_REPEATED, "entry", "sha256", "reached_at")]
        place: sa.BindParameter[int] = sa.bindparam("place")
        query = sa.select(*columns).where(_LEDGER.sequence > place, _LEDGER.sequence <= self._end)
        query = query.order_by(_LEDGER.sequence).limit(_A_TIME)
        newest = self._before.sequence
        while rows := self._connection.execute(query, {"place": newest}).cursor.fetchall():
            yield [entry for row in rows if (entry := self._entry(*row)) is not None]
            self._verification.entries += len(rows)
            if self._before.sequence <= newest:  # only of a damaged file: following its order would never end
                self._verification.find("ledger", f"an earlier entry stands behind entry {newest}: the file is damaged")
                return
            newest = self._before.sequence

    def _entry(self, *row: Any) -> Entry | None:
        *repeated, text, sha256, reached_at = row
        sequence, find = repeated[0], self._verification.find
        if not _is_head(sequence, sha256, reached_at):
            find(f"entry {sequence}", "a column of it is of another kind: the file is damaged")
            return None
        if sequence != self._before.sequence + 1:
            find(f"entry {self._before.sequence + 1}", f"missing up to entry {sequence - 1}: deleted, or never there")
        if not isinstance(text, str) or sha256_of(text) != sha256:
            find(f"entry {sequence}", "its text has not its hash: changed")
        entry = _parsed(text)
        if entry is None:
            find(f"entry {sequence}", "its text is no entry: changed")
        else:
            self._follow(entry, repeated, reached_at)
        self._before = Head(sequence, sha256, reached_at)
        return entry

    def _follow(self, entry: Entry, repeated: list[Any], reached_at: str) -> None:
        before, expected = self._before, str(entry.get("recorded_at"))
        if expected < before.reached_at:
            expected = before.reached_at
        if entry.get("previous") != before.sha256:
            self._find(repeated, "does not follow the entry before it: one of the two is not what was written")
        if [entry.get(name) for name in _REPEATED] != repeated:
            self._find(repeated, "a column that repeats its text says otherwise: changed")
        if reached_at != expected:
            self._find(repeated, f"reached_at is {reached_at} instead of {expected}: changed")

    def _find(self, repeated: list[Any], what: str) -> None:
        self._verification.find(f"entry {repeated[0]}", what)


def _before(connection: Connection, first: int) -> Head:
    """What stands before an entry; where that is missing too, the walk that ends there has said so."""
    query = sa.select(_LEDGER.sequence, _LEDGER.sha256, _LEDGER.reached_at).where(_LEDGER.sequence < first)
    row = connection.execute(query.order_by(_LEDGER.sequence.desc()).limit(1)).first()
    return Head(*row) if row is not None and _is_head(*row) else BEFORE_THE_FIRST


def _is_head(sequence: object, sha256: object, reached_at: object) -> bool:
    """The columns' constraints say so; a damaged file keeps to none."""
    return isinstance(sequence, int) and isinstance(sha256, str) and isinstance(reached_at, str)


def _parsed(text: Any) -> Entry | None:
    try:
        entry = orjson.loads(text)
    except (ValueError, TypeError):
        return None
    return entry if isinstance(entry, dict) and _has_shape(entry) else None


def _has_shape(entry: Entry) -> bool:
    """Whether it has a number, and rows as everything behind this relies on: else a changed text would end the walk."""
    rows = entry.get("rows")
    if not isinstance(entry.get("sequence"), int) or not isinstance(rows, dict):
        return False
    return all(isinstance(some, list) and all(map(_vouches, some)) for some in rows.values())


def _vouches(one: Any) -> bool:
    """A key and a hash."""
    match one:
        case [[str() | int(), *more], str()]:
            return all(isinstance(part, str | int) for part in more)
    return False
