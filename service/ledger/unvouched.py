"""Rows that no entry of the ledger vouches for: inserted past it."""

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.ledger.chain_check import ChainCheck
from service.ledger.findings import Verification
from service.ledger.rows import key_columns
from service.ledger.rows_check import TABLES, shown, vouched_for

_SHOWN = 20


def find_unvouched(connection: Connection, verification: Verification, newest: int) -> None:
    """Count each table against what is vouched for, and look for the rows themselves where the count is wrong."""
    for name, table in TABLES.items():
        count = connection.execute(sa.select(sa.func.count()).select_from(table)).scalar_one()
        if count != verification.vouched[name]:
            _locate(connection, verification, table, newest)


def _locate(connection: Connection, verification: Verification, table: sa.Table, newest: int) -> None:
    walk = ChainCheck(connection, Verification(), 1, newest)
    known = {key for entries in walk.entries() for name, key, *_ in vouched_for(entries) if name == table.name}
    there = (tuple(row) for row in connection.execute(sa.select(*key_columns(table)).distinct()))
    unknown = [key for key in there if key not in known]
    for key in unknown[:_SHOWN]:
        verification.find(f"{table.name} {shown(key)}", "no entry vouches for it: inserted past the ledger")
    if len(unknown) > _SHOWN:
        verification.find(table.name, f"{len(unknown) - _SHOWN} more rows that no entry vouches for")
