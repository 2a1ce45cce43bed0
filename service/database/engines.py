"""Two engines on one database: a writer whose transactions never overlap, and a reader that cannot write.

SQLite under SQLAlchemy loses updates by default: its transactions begin at the first write, after the read that
decided. Here every write transaction begins with BEGIN IMMEDIATE (SQLite) or an advisory lock (PostgreSQL).
"""

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any

import sqlalchemy as sa
from psycopg.errors import LockNotAvailable
from sqlalchemy.engine import Connection, Engine
from sqlalchemy.exc import DatabaseError, DataError, DBAPIError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeout

from service.database.json_text import to_text
from service.database.postgresql import BUSY_S, NoAnswerError, expect_answers, postgresql_engine
from service.database.turns import Turns
from service.errors import ErrorCode, ServiceError
from service.ledger.keys import Signer
from service.ledger.sealing import sealed

# Pages in the write-ahead log at which a commit empties it by itself: 16 MB, more than the images of four senders, who
# empty it outside their turn.
_LOG_PAGES = 4000
# Any constant will do, as long as every writer of this schema takes the same one.
_WRITER_LOCK = 0x636F6178
# Parameters are hidden because an error's text goes to the log, and patient data never does.
_OPTIONS: dict[str, Any] = {"json_serializer": to_text, "hide_parameters": True}


@dataclass(slots=True)
class Database:
    """The two engines, and who wants to hear of every commit."""

    writer: Engine
    reader: Engine
    signer: Signer | None = None  # without one the ledger grows, but no checkpoint is signed
    on_commit: list[Callable[[], None]] = field(default_factory=list)
    turns: Turns = field(default_factory=lambda: Turns(BUSY_S))

    @contextmanager
    def write(self, *, bulky: bool = False) -> Iterator[Connection]:
        """One write transaction: sealed and committed at its end, rolled back by an exception, never beside another.

        A `bulky` one, which holds an image, lets every other go first, and tidies up only when its turn is over.
        """
        with _typed_faults():
            with self.turns.taken(bulky=bulky), self.writer.begin() as connection, sealed(connection, self.signer):
                yield connection
            if bulky and self.writer.dialect.name == "sqlite":
                self._empty_log()
        for listener in self.on_commit:
            listener()

    @contextmanager
    def read(self) -> Iterator[Connection]:
        """One consistent view of the database; a write in it raises."""
        with _typed_faults(), self.reader.begin() as connection:
            yield connection

    def prove(self) -> None:
        """Connect once, so that what is wrong with the database is told now; ServiceError."""
        try:
            with _typed_faults(), self.writer.connect():
                return
        except UnicodeDecodeError as error:  # SQLite's message quotes text of a damaged schema
            raise ServiceError(ErrorCode.DATABASE_FAULT, "the database file is damaged") from error

    def expect_answers(self, within_s: float = BUSY_S) -> None:
        """From now on wait no longer for an answer, as a service must not: a migration or a long search may.

        A file of SQLite's is its own answer.
        """
        for engine in (self.writer, self.reader):
            if engine.dialect.name == "postgresql":
                expect_answers(engine, within_s)

    def _empty_log(self) -> None:
        """Copy what is in the write-ahead log into the file; writers go on meanwhile.

        Where that fails, on a full disk, what was committed stands, and the next one tries again.
        """
        with suppress(sqlite3.Error), closing(self.writer.raw_connection()) as connection:
            connection.cursor().execute("PRAGMA wal_checkpoint(PASSIVE)")

    def close(self) -> None:
        """Close every connection of both engines."""
        self.writer.dispose()
        self.reader.dispose()


def open_database(url: str, signer: Signer | None = None) -> Database:
    """Engines for `url`; the schema is the migrations' affair. Raises ServiceError where a PRAGMA does not hold."""
    address = sa.make_url(url)
    if address.get_backend_name() == "sqlite":
        database = Database(_sqlite_engine(address, writes=True), _sqlite_engine(address, writes=False), signer)
    else:
        address = address.set(drivername="postgresql+psycopg")
        database = Database(_postgresql_engine(address, writes=True), _postgresql_engine(address, writes=False), signer)
    database.prove()
    return database


def _sqlite_engine(address: sa.URL, *, writes: bool) -> Engine:
    connect_args = {"timeout": BUSY_S, "check_same_thread": False}
    engine = sa.create_engine(address, **_OPTIONS, connect_args=connect_args)

    @sa.event.listens_for(engine, "connect")
    def prepare(dbapi: Any, _record: Any) -> None:
        dbapi.isolation_level = None  # the driver begins nothing by itself
        _assert_pragma(dbapi, "journal_mode", "WAL", "wal")
        _assert_pragma(dbapi, "synchronous", "FULL", 2)  # H25: WAL at NORMAL lost commits in two thirds of power cuts
        _assert_pragma(dbapi, "foreign_keys", "ON", 1)
        _assert_pragma(dbapi, "recursive_triggers", "ON", 1)  # else REPLACE deletes rows past the append-only triggers
        dbapi.execute(f"PRAGMA wal_autocheckpoint={_LOG_PAGES}")
        if not writes:
            _assert_pragma(dbapi, "query_only", "ON", 1)

    @sa.event.listens_for(engine, "begin")
    def begin(connection: Connection) -> None:
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN DEFERRED")

    return engine


def _assert_pragma(dbapi: Any, name: str, value: str, expected: object) -> None:
    dbapi.execute(f"PRAGMA {name}={value}")
    found = dbapi.execute(f"PRAGMA {name}").fetchone()[0]
    if found != expected:
        raise ServiceError(ErrorCode.DATABASE_FAULT, f"SQLite keeps {name} at {found} instead of {value}")


def _postgresql_engine(address: sa.URL, *, writes: bool) -> Engine:
    engine = postgresql_engine(address, writes=writes, options=_OPTIONS)
    if writes:

        @sa.event.listens_for(engine, "begin")
        def begin(connection: Connection) -> None:
            connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({_WRITER_LOCK})")

    return engine


@contextmanager
def _typed_faults() -> Iterator[None]:
    """Lock waits, full disks, I/O errors, damaged files and values that no column holds as ServiceError.

    Broken constraints stay what they are.
    """
    try:
        yield
    except PoolTimeout as error:  # every connection waits, as for a server that fell silent
        raise ServiceError(ErrorCode.DATABASE_BUSY, "every connection to the database is in use") from error
    except DataError as error:  # PostgreSQL alone: SQLite keeps any text
        raise ServiceError(ErrorCode.MALFORMED_REQUEST, "a text or a number is none that a record can hold") from error
    except OperationalError as error:
        raise _fault(error) from error
    except DatabaseError as error:
        # Else a kind of it that says more than that the file is damaged, or that the server has ended the session.
        if type(error) is not DatabaseError and not error.connection_invalidated:
            raise
        raise _fault(error) from error


def _fault(error: DBAPIError) -> ServiceError:
    text = str(error.orig)
    if "locked" in text or "busy" in text or isinstance(error.orig, LockNotAvailable):
        return ServiceError(ErrorCode.DATABASE_BUSY, "another writer held the database too long", limit=BUSY_S)
    if isinstance(error.orig, NoAnswerError):
        return ServiceError(ErrorCode.DATABASE_FAULT, f"the database server is silent ({text})")
    if "full" in text or "No space" in text:
        return ServiceError(ErrorCode.DISK_FULL, "the disk is full")
    # Before any statement it is about address, rights or file; later its text may quote what is recorded.
    reason = type(error.orig).__name__ if error.statement else " ".join(text.split())
    return ServiceError(ErrorCode.DATABASE_FAULT, f"the database cannot be used ({reason})")
