"""One service per room (H19): a lock that the operating system or the database server frees with its holder.

No lease with a time-out: a service that was killed can start again at once, and one that only hangs keeps its room.
"""

import fcntl
import os
import socket
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import sqlalchemy as sa

from service.database import tables
from service.database.clock import now_utc
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError


@contextmanager
def room_claim(database: Database, room: str) -> Iterator[None]:
    """Hold the room; ServiceError ROOM_CLAIMED if another service does (on SQLite: any service on this file)."""
    lock = _file_lock if database.writer.dialect.name == "sqlite" else _server_lock
    with lock(database, room) as taken:
        if not taken:
            raise ServiceError(ErrorCode.ROOM_CLAIMED, f"room {room} is run by {_holder(database, room)}")
        _write_holder(database, room)
        yield


@contextmanager
def _file_lock(database: Database, room: str) -> Iterator[bool]:
    del room  # an embedded database has one room
    with Path(f"{database.writer.url.database}.claim").open("w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            yield False
        else:
            yield True


@contextmanager
def _server_lock(database: Database, room: str) -> Iterator[bool]:
    with database.writer.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        query = sa.text("SELECT pg_try_advisory_lock(1, :room)")
        try:
            yield bool(connection.execute(query, {"room": zlib.crc32(room.encode()) - 2**31}).scalar())
        finally:
            connection.invalidate()  # a pooled connection would keep the lock


def _holder(database: Database, room: str) -> str:
    with database.read() as connection:
        if not sa.inspect(connection).has_table("room_claims"):
            return "another service, which has just started"
        query = sa.select(tables.room_claims.c.holder).where(tables.room_claims.c.room == room)
        return connection.execute(query).scalar() or "another service"


def _write_holder(database: Database, room: str) -> None:
    claims = tables.room_claims
    values = {"holder": f"process {os.getpid()} on {socket.gethostname()}", "claimed_at": now_utc()}
    with database.write() as connection:
        if connection.execute(sa.update(claims).where(claims.c.room == room).values(values)).rowcount == 0:
            connection.execute(sa.insert(claims).values(room=room, **values))
