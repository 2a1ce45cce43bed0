"""One service per room (H19): a lock that the operating system or the database server frees with its holder.

No lease with a time-out: a service that was killed can start again at once, and one that only hangs keeps its room.
"""

import fcntl
import os
import socket
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psycopg
import sqlalchemy as sa

from service.audit import record_audit
from service.database import tables
from service.database.clock import now_utc
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError

HOLDER_GONE_MS = 1000
"""A server frees the lock of a holder that has ended once it has seen its connection close: a moment later."""


@contextmanager
def room_claim(database: Database, room: str, reason: str | None = None) -> Iterator[None]:
    """Hold the room, and give it up at the end; ServiceError ROOM_CLAIMED or ROOM_LEFT.

    Another service that runs keeps it (on SQLite: any service on this file). One of another workstation that ended
    without giving it up may still drive the arm from there, behind a network that is down: only a person's `reason`
    claims the room from it, and is recorded.
    """
    lock = _file_lock if database.writer.dialect.name == "sqlite" else _server_lock
    with lock(database, room) as taken:
        if not taken:
            raise ServiceError(ErrorCode.ROOM_CLAIMED, f"room {room} is run by {_holder(database, room)}")
        _claim(database, room, reason)
        yield
        _give_up(database, room)


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
        try:
            yield _taken(connection, {"room": zlib.crc32(room.encode()) - 2**31})
        finally:
            connection.invalidate()  # a pooled connection would keep the lock


def _taken(connection: sa.Connection, room: dict[str, int]) -> bool:
    connection.execute(sa.text(f"SET lock_timeout = '{HOLDER_GONE_MS}ms'"))
    try:
        connection.execute(sa.text("SELECT pg_advisory_lock(1, :room)"), room)
    except sa.exc.OperationalError as refused:
        if isinstance(refused.orig, psycopg.errors.LockNotAvailable):
            return False
        raise
    return True


def _holder(database: Database, room: str) -> str:
    with database.read() as connection:
        if not sa.inspect(connection).has_table("room_claims"):
            return "another service, which has just started"
        query = sa.select(tables.room_claims.c.holder).where(tables.room_claims.c.room == room)
        return connection.execute(query).scalar() or "another service"


def _claim(database: Database, room: str, reason: str | None) -> None:
    claims, here = tables.room_claims, socket.gethostname()
    with database.write() as connection:
        left_by = connection.execute(sa.select(claims.c.holder).where(claims.c.room == room)).scalar()
        if left_by is not None and not left_by.endswith(f" on {here}"):
            if reason is None:
                raise ServiceError(ErrorCode.ROOM_LEFT, f"room {room} was last run by {left_by}, which did not end it")
            data = {"room": room, "reason": reason, "left_by": left_by, "claimed_by": here}
            record_audit(connection, "room_claimed", None, data)
        connection.execute(sa.delete(claims).where(claims.c.room == room))
        holder = f"process {os.getpid()} on {here}"
        connection.execute(sa.insert(claims).values(room=room, holder=holder, claimed_at=now_utc()))


def _give_up(database: Database, room: str) -> None:
    # What cannot be written any more stays this workstation's, where the service starts again without a reason.
    with suppress(ServiceError), database.write() as connection:
        connection.execute(sa.delete(tables.room_claims).where(tables.room_claims.c.room == room))
