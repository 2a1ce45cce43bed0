"""Compares record rows with the hashes that the ledger has of them."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.ledger.chain_check import Entry
from service.ledger.findings import Verification
from service.ledger.rows import Key, Row, digest, key_columns, key_reader, stored_columns

# Ranges in one query: SQLite nests no deeper than 1000, and each costs a little to prepare.
_RUNS = 200
TABLES = {table.name: table for table in tables.RECORDS}


class RowsCheck:
    """Counts the rows that are vouched for while it compares them."""

    def __init__(self, connection: Connection, verification: Verification) -> None:
        self._connection = connection
        self._verification = verification

    def take(self, entries: Iterable[Entry]) -> None:
        """Compare the rows of some entries."""
        wanted: dict[str, dict[Key, tuple[str, int]]] = defaultdict(dict)
        for name, key, expected, sequence in vouched_for(entries):
            wanted[name][key] = (expected, sequence)
        for name, keys in wanted.items():
            if name in TABLES:
                self._compare(TABLES[name], keys)
            else:
                self._verification.find(f"entry {next(iter(keys.values()))[1]}", f"vouches for no table: {name}")

    def _compare(self, table: sa.Table, keys: dict[Key, tuple[str, int]]) -> None:
        found, find = self._rows(table, list(keys)), self._verification.find
        for key, (expected, sequence) in keys.items():
            rows = found.get(key)
            if rows is None:
                find(f"{table.name} {shown(key)}", f"missing: entry {sequence} vouches for it")
                continue
            if digest(table, rows) != expected:
                find(f"{table.name} {shown(key)}", f"not what entry {sequence} vouches for: changed")
            self._verification.vouched[table.name] += len(rows)

    def _rows(self, table: sa.Table, keys: list[Key]) -> dict[Key, list[Row]]:
        query = sa.select(*stored_columns(table, self._connection.dialect.name)).where(_among(table, keys))
        # The driver's own tuples: these are the raw values, and to wrap them takes longer than to hash them.
        found: dict[Key, list[Row]] = defaultdict(list)
        read_key = key_reader(table)
        for row in self._connection.execute(query).cursor.fetchall():
            found[read_key(row)].append(row)
        return found


def _among(table: sa.Table, keys: list[Key]) -> sa.ColumnElement[bool]:
    """The rows of these keys; numbers were given one after another, so that a range is all of them."""
    columns = key_columns(table)
    if all(isinstance(key[-1], int) for key in keys):
        runs: dict[Key, list[int]] = defaultdict(list)
        for key in keys:
            runs[key[:-1]].append(key[-1])
        if len(runs) <= _RUNS:
            return sa.or_(*(_in_run(columns, *run) for run in runs.items()))
    return sa.tuple_(*columns).in_(keys) if len(columns) > 1 else columns[0].in_([key[0] for key in keys])


def _in_run(columns: tuple[sa.Column[Any], ...], group: Key, numbers: list[int]) -> sa.ColumnElement[bool]:
    alike = (column == value for column, value in zip(columns, group, strict=False))
    return sa.and_(*alike, columns[-1].between(min(numbers), max(numbers)))


def vouched_for(entries: Iterable[Entry]) -> Iterator[tuple[str, Key, str, int]]:
    """Table, key, hash and entry of everything that some entries vouch for."""
    for entry in entries:
        for name, rows in entry["rows"].items():
            for key, expected in rows:
                yield name, tuple(key), expected, entry["sequence"]


def shown(key: Key) -> str:
    """A key as findings name it."""
    return "/".join(map(str, key))
