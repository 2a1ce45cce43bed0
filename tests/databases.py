"""Databases for tests: files of SQLite, or databases of one PostgreSQL server (`pytest --database postgresql`)."""

import shutil
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, closing, contextmanager
from functools import cached_property
from itertools import count
from pathlib import Path
from typing import Any, Protocol

import psycopg
import sqlalchemy as sa

from service.database import tables
from service.database.engines import open_database
from service.database.migrate import migrate

# Every table that nobody may change rows of.
ALL = (*tables.RECORDS, *tables.LEDGER)


class Attacker(Protocol):
    """Somebody who changes a database past the service and its triggers; placeholders are `?`, a row is its `rowid`."""

    def execute(self, statement: str, values: Sequence[Any] = ()) -> Any:
        """Run one statement; what it answers has `fetchone` and `fetchall`."""
        ...


class Databases(Protocol):
    """One kind of database, made for a test and gone after it."""

    dialect: str

    def empty(self, folder: Path) -> AbstractContextManager[str]:
        """The address of a database without a schema; a file lies in `folder`."""
        ...

    def migrated(self, folder: Path) -> AbstractContextManager[str]:
        """The address of an empty database with today's schema."""
        ...

    def copied(self, address: str, folder: Path) -> AbstractContextManager[str]:
        """The address of a copy of a database that nobody has open."""
        ...

    def loaded(self, statements: str, folder: Path) -> AbstractContextManager[str]:
        """The address of a database that a dump makes."""
        ...

    def attack(self, address: str) -> AbstractContextManager[Attacker]:
        """Change a database as somebody does who has it: no triggers, no foreign keys; put back and committed."""
        ...


class SqliteFiles:
    """Files in the folders of the tests."""

    dialect = "sqlite"

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    @cached_property
    def _migrated(self) -> str:
        """Migrating takes a third of a second, copying nothing."""
        address = _address_of(self._folder)
        _migrate(address)
        return address

    @contextmanager
    def empty(self, folder: Path) -> Iterator[str]:
        yield _address_of(folder)

    def migrated(self, folder: Path) -> AbstractContextManager[str]:
        return self.copied(self._migrated, folder)

    @contextmanager
    def copied(self, address: str, folder: Path) -> Iterator[str]:
        copy = _address_of(folder)
        shutil.copy(file_of(address), file_of(copy))
        yield copy

    @contextmanager
    def loaded(self, statements: str, folder: Path) -> Iterator[str]:
        address = _address_of(folder)
        with closing(sqlite3.connect(file_of(address))) as connection:
            connection.executescript(statements)
        yield address

    @contextmanager
    def attack(self, address: str) -> Iterator[Attacker]:
        with closing(sqlite3.connect(file_of(address))) as connection, connection:
            triggers = connection.execute("SELECT name, sql FROM sqlite_master WHERE type = 'trigger'").fetchall()
            for name, _ in triggers:
                connection.execute(f"DROP TRIGGER {name}")
            yield connection
            for _, text in triggers:
                connection.execute(text)


class PostgresqlDatabases:
    """Databases of one server, copied from templates."""

    dialect = "postgresql"

    def __init__(self, server: str) -> None:
        self._server = server
        self._numbers = count()

    @cached_property
    def _migrated(self) -> str:
        address = self._named("migrated")
        self._on_server("CREATE DATABASE migrated")
        _migrate(address)
        return address

    def empty(self, folder: Path) -> AbstractContextManager[str]:
        return self.copied(self._named("template1"), folder)

    def migrated(self, folder: Path) -> AbstractContextManager[str]:
        return self.copied(self._migrated, folder)

    @contextmanager
    def copied(self, address: str, folder: Path) -> Iterator[str]:
        del folder
        name = f"test_{next(self._numbers)}"
        self._on_server(f"CREATE DATABASE {name} TEMPLATE {sa.make_url(address).database}")
        yield self._named(name)
        self._on_server(f"DROP DATABASE {name} WITH (FORCE)")

    @contextmanager
    def loaded(self, statements: str, folder: Path) -> Iterator[str]:
        with self.empty(folder) as address:
            with psycopg.connect(address) as connection:
                connection.execute(statements.encode())
            yield address

    @contextmanager
    def attack(self, address: str) -> Iterator[Attacker]:
        with psycopg.connect(address) as connection:
            connection.execute("SET session_replication_role = replica")
            yield _AsSqlite(connection)

    def _named(self, name: str) -> str:
        return self._server.rpartition("/")[0] + f"/{name}"

    def _on_server(self, statement: str) -> None:
        with psycopg.connect(self._server, autocommit=True) as connection:
            connection.execute(statement)


class _AsSqlite:
    """Takes statements as SQLite does: `?` for a value, `rowid` for a row's place."""

    def __init__(self, connection: psycopg.Connection[Any]) -> None:
        self._connection = connection

    def execute(self, statement: str, values: Sequence[Any] = ()) -> Any:
        return self._connection.execute(statement.replace("?", "%s").replace("rowid", "ctid"), values)


def file_of(address: str) -> Path:
    """The file of an SQLite database."""
    return Path(sa.make_url(address).database)


def _address_of(folder: Path) -> str:
    return f"sqlite:///{folder / 'coaxial.sqlite'}"


def _migrate(address: str) -> None:
    database = open_database(address)
    migrate(database)
    database.close()
