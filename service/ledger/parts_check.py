"""Entries and their rows, part by part, in as many processes as are given."""

import gc
import os
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any

import psycopg
from sqlalchemy.engine import Connection
from sqlalchemy.exc import DatabaseError

from service.database.engines import Database, open_database
from service.ledger.chain_check import ChainCheck, Entry
from service.ledger.findings import Verification
from service.ledger.rows_check import RowsCheck
from workflow.states import State
from workflow.triggers import Trigger

# Entries that one process looks at before it tells: seconds of work.
_A_PART = 10_000
# A verification beside a procedure leaves the cores to it.
_NICE = 15
# Objects between two collections: what is read are trees, freed without one, and looking for cycles in them every 700
# took a quarter of the time.
_COLLECT_AFTER = 500_000
# Raised by the drivers themselves where their rows are fetched, else by what is around them.
_UNREADABLE = (DatabaseError, sqlite3.Error, psycopg.Error)
Check = Callable[[Connection, Verification], None]


def check_parts(database: Database, newest: int, workers: int) -> Iterator[Verification]:
    """What is found in each part of the ledger up to entry `newest`."""
    ranges = [(first, min(first + _A_PART - 1, newest)) for first in range(1, newest + 1, _A_PART)]
    if workers == 1 or len(ranges) == 1:
        yield from (check_part(database, *one) for one in ranges)
        return
    url = database.reader.url.render_as_string(hide_password=False)
    with get_context("spawn").Pool(workers, _begin_worker) as pool:
        yield from pool.imap(_check_part_of, [(url, *one) for one in ranges])


def check_part(database: Database, first: int, last: int) -> Verification:
    """What is found from one entry to another."""

    def check(connection: Connection, verification: Verification) -> None:
        rows = RowsCheck(connection, verification)
        for entries in ChainCheck(connection, verification, first, last).entries():
            rows.take(entries)
            verification.closings += [entry["sequence"] for entry in entries if _is_closing(entry)]

    return read_all(database, check)


def read_all(database: Database, check: Check) -> Verification:
    """What a check finds, also where text is no text any more or the file cannot be read to its end."""
    with database.reader.connect() as connection:
        verification, error = _tried(connection, check)
        if error is not None and "decode" in str(error):
            with _any_text(connection):
                verification, error = _tried(connection, check)
    if error is not None:
        verification.find("database", f"cannot be read to its end: {getattr(error, 'orig', error)}")
    return verification


def _tried(connection: Connection, check: Check) -> tuple[Verification, Exception | None]:
    """What a check finds, and what kept it from its end."""
    verification = Verification()
    try:
        check(connection, verification)
    except _UNREADABLE as error:
        return verification, error
    return verification, None


@contextmanager
def _any_text(connection: Connection) -> Iterator[None]:
    """Text that is no UTF-8 any more is read nevertheless, to be found wrong; slower than SQLite's own way."""
    dbapi: Any = connection.connection.dbapi_connection
    dbapi.text_factory = lambda raw: raw.decode(errors="backslashreplace")
    try:
        yield
    finally:
        dbapi.text_factory = str


def _begin_worker() -> None:
    os.nice(_NICE)
    gc.set_threshold(_COLLECT_AFTER)


def _check_part_of(part: tuple[str, int, int]) -> Verification:
    url, first, last = part
    database = open_database(url)
    try:
        return check_part(database, first, last)
    finally:
        database.close()


def _is_closing(entry: Entry) -> bool:
    return entry.get("action") == Trigger.CASE_CLOSED and entry.get("after") == State.CLOSED
