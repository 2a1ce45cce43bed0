"""Record rows, added here and nowhere else, so that none can be without its hash in the ledger.

A row's hash is over the values as the database holds them, JSON as its stored text: what a reader hashes again is what
was written, to the bit. Bytes enter by their own SHA-256. The values stand in the order of the table's columns, and
missing ones at the end are left out: a column that a later version adds behind the others changes no hash.
"""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from operator import itemgetter
from typing import Any

import orjson
import sqlalchemy as sa
from sqlalchemy.engine import Connection
from sqlalchemy.sql.dml import ReturningInsert

from service.ledger.draft import draft_of

# Rows that belong together are hashed together: the verdicts of an attempt, the planned targets of a case.
_GROUPED: dict[str, tuple[str, ...]] = {"verdicts": ("attempt_id",), "planned_targets": ("case_id",)}
# The values of a row in the order of its columns.
Row = tuple[Any, ...]
Key = tuple[Any, ...]


def add_rows(connection: Connection, table: sa.Table, rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Insert record rows and have the ledger vouch for them at the end of the transaction; the rows as stored."""
    binary = _binary(table)
    answered = connection.execute(_insertion(table, connection.dialect.name), list(rows)).mappings()
    found: list[Mapping[str, Any]] = [{**row} for row in answered]
    if binary:  # hashed as given: an image is not read back; such rows come alone, so that no order matters
        (given,) = rows
        found = [{**found[0]} | {name: given.get(name) for name in binary}]
    draft, names = draft_of(connection), [column.name for column in table.columns]
    for row in found:
        values = tuple(row[name] for name in names)
        draft.cover(table, key_of(table, values), values)
    return found


@cache
def _binary(table: sa.Table) -> tuple[str, ...]:
    return tuple(column.name for column in table.columns if isinstance(column.type, sa.LargeBinary))


@cache
def _insertion(table: sa.Table, dialect: str) -> ReturningInsert[Any]:
    columns = [column for column in stored_columns(table, dialect) if column.key not in _binary(table)]
    return sa.insert(table).returning(*columns)


@cache
def stored_columns(table: sa.Table, dialect: str) -> tuple[sa.ColumnElement[Any], ...]:
    """The columns of a table, each as the database holds it: JSON as text, truth values as numbers."""
    return tuple(_stored(column, dialect) for column in table.columns)


def _stored(column: sa.Column[Any], dialect: str) -> sa.ColumnElement[Any]:
    raw: sa.types.TypeEngine[Any]
    match column.type:
        case sa.JSON():
            raw = sa.Text()
        case sa.Boolean():
            raw = sa.Integer()
        case _:
            return column
    # SQLite is asked for its value untouched: a cast would round its numbers.
    changed: sa.ColumnElement[Any] = sa.type_coerce(column, raw) if dialect == "sqlite" else sa.cast(column, raw)
    return changed.label(column.name)


@cache
def key_columns(table: sa.Table) -> tuple[sa.Column[Any], ...]:
    """The columns that name what is hashed together: the primary key, or that of the group."""
    names = _GROUPED.get(table.name)
    return tuple(table.columns[name] for name in names) if names else tuple(table.primary_key.columns)


@cache
def key_reader(table: sa.Table) -> Callable[[Row], Key]:
    """What finds the key in a row: verification calls it for every row of the record."""
    names = [column.name for column in table.columns]
    places = [names.index(column.name) for column in key_columns(table)]
    if len(places) > 1:
        return itemgetter(*places)
    (place,) = places
    return lambda row: (row[place],)


@cache
def _last_key_place(table: sa.Table) -> int:
    names = [column.name for column in table.columns]
    return names.index(list(table.primary_key.columns)[-1].name)


def key_of(table: sa.Table, row: Row) -> Key:
    """The values that name a row or its group."""
    return key_reader(table)(row)


def digest(table: sa.Table, rows: Sequence[Row]) -> str:
    """SHA-256 over rows that are hashed together, in whatever order they come."""
    if len(rows) > 1:
        place = _last_key_place(table)
        rows = sorted(rows, key=lambda row: str(row[place]))
    return hashlib.sha256(orjson.dumps([_trimmed(row) for row in rows], default=_hashed)).hexdigest()


def _trimmed(row: Row) -> Row:
    while row and row[-1] is None:
        row = row[:-1]
    return row


def _hashed(value: bytes | memoryview) -> dict[str, str]:
    return {"sha256": hashlib.sha256(value).hexdigest()}
