"""The first entries of a ledger, written in the transaction that makes its tables.

Rows that are older than the ledger are vouched for from here on, and their entries say so.
"""

from collections.abc import Iterator
from itertools import groupby, islice

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.ledger.checkpoints import sign_head
from service.ledger.draft import Draft
from service.ledger.entries import BEFORE_THE_FIRST, append_entry
from service.ledger.keys import Signer
from service.ledger.rows import Key, Row, key_columns, key_of, stored_columns
from service.version import PRODUCT_VERSION

BEGUN, TAKEN_IN = "ledger_begun", "taken_into_the_ledger"
_MARKER = "these rows are older than the ledger: vouched for from here on, not for the time before"
_GROUPS_AN_ENTRY = 500

Group = tuple[Key, list[Row]]


def begin_ledger(connection: Connection, signer: Signer | None) -> None:
    """Write the first entry, then entries over every record row that there is already."""
    head = append_entry(connection, Draft(action=BEGUN, payload={"product_version": PRODUCT_VERSION}), BEFORE_THE_FIRST)
    for table in tables.RECORDS:
        groups = _groups(connection, table)
        while some := dict(islice(groups, _GROUPS_AN_ENTRY)):
            draft = Draft(covered={table: some}, action=TAKEN_IN, payload={"marker": _MARKER})
            head = append_entry(connection, draft, head)
    if signer is not None:
        sign_head(connection, head, signer, BEGUN)


def _groups(connection: Connection, table: sa.Table) -> Iterator[Group]:
    """The rows of a table by what is hashed together, in the order of their keys."""
    columns = stored_columns(table, connection.dialect.name)
    query = sa.select(*columns).order_by(*key_columns(table), *table.primary_key.columns)
    rows = map(tuple, connection.execute(query))
    for key, together in groupby(rows, lambda row: key_of(table, row)):
        yield key, list(together)
