"""Server-side sessions: an opaque token, of which the database holds only the hash."""

import hashlib
import secrets
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any
from uuid import uuid4

import sqlalchemy as sa

from service.auth.permissions import Role
from service.auth.session import Session, SessionStatus
from service.auth.users import User
from service.auth.uses import SessionUses
from service.database import tables
from service.database.clock import now_utc
from service.database.engines import Database
from service.settings import SessionSettings

# A session's last use is written at most this often: reading the status must not cost a disk write each time.
_SEEN_STEP_S = 10.0
# So far a clock is corrected now and then; put back further, it does not tell how long a session was left alone.
_PUT_BACK_S = 60.0
# Sessions that are over may still stop, so they are remembered: 5 MB of them, some months of a room. Beyond that those
# give way that have been over for longest, and whoever has only such a one signs in again to stop by the tablet.
MOST_REMEMBERED = 10_000
# Neither revoked nor of a user who was disabled.
_ALIVE = (
    sa.select(tables.sessions, tables.users.c.name, tables.users.c.role)
    .join(tables.users, tables.users.c.id == tables.sessions.c.user_id)
    .where(tables.sessions.c.revoked_at.is_(None), tables.users.c.disabled_at.is_(None))
)
_NEWEST_FIRST = _ALIVE.order_by(tables.sessions.c.expires_at_s.desc())
_ALIVE_BY_TOKEN = _ALIVE.where(tables.sessions.c.token_sha256 == sa.bindparam("token_sha256"))


class SessionStore:
    """Sessions in the database, and in memory who may stop: stop asks no database."""

    def __init__(self, database: Database, settings: SessionSettings, now_s: Callable[[], float] = time.time) -> None:
        self._database = database
        self._settings = settings
        self._now_s = now_s
        self._uses = SessionUses(database)
        self._remembering = threading.Lock()
        with database.read() as connection:
            newest_first = list(self._worth_remembering(connection.execute(_NEWEST_FIRST)))
        self._remembered = dict(reversed(newest_first))

    def create(self, user: User) -> tuple[str, Session]:
        """A session for a user who has proved a password: its token, told once, and the session."""
        token, now_s = secrets.token_urlsafe(32), self._now_s()
        expires_at_s = now_s + self._settings.lifetime_s
        session = Session(uuid4().hex, user.id, user.name, user.role, SessionStatus.ACTIVE, expires_at_s)
        with self._database.write() as connection:
            connection.execute(
                sa.insert(tables.sessions).values(
                    id=session.id,
                    token_sha256=_digest(token),
                    user_id=user.id,
                    created_at=now_utc(),
                    expires_at_s=expires_at_s,
                    last_seen_at_s=now_s,
                )
            )
        self._remember(token, session)
        return token, session

    def find(self, token: str) -> Session | None:
        """The session of a token, with what it is still good for; None if unknown, revoked or the user is disabled."""
        row = self._row(token)
        if row is None:
            return None
        session = self._session(row)
        if session.status is SessionStatus.ACTIVE and self._now_s() - self._last_use_s(row) > _SEEN_STEP_S:
            self._uses.note(session.id, self._now_s())
        return session

    def look(self, token: str) -> Session | None:
        """As `find`, without counting as a use: a stream that nobody touches must not keep its session from locking."""
        row = self._row(token)
        return None if row is None else self._session(row)

    def _row(self, token: str) -> sa.Row[Any] | None:
        with self._database.read() as connection:
            row = connection.execute(_ALIVE_BY_TOKEN, {"token_sha256": _digest(token)}).first()
        if row is None:
            self._forget(token)
        return row

    def remembered(self, token: str) -> Session | None:
        """The session of a token from memory alone, its status unknown to it: enough for a stop."""
        return self._remembered.get(_digest(token))

    def close(self) -> None:
        """Write no more uses."""
        self._uses.close()

    def lock(self, session: Session) -> None:
        """Lock until the PIN is entered."""
        self._set(session.id, locked_at=now_utc())

    def unlock(self, session: Session) -> Session:
        """Make a locked session active; the caller has checked the PIN."""
        self._set(session.id, locked_at=None, last_seen_at_s=self._now_s())
        self._uses.forget(session.id)
        return replace(session, status=SessionStatus.ACTIVE)

    def revoke(self, token: str) -> None:
        """Sign out: the token is good for nothing from now on."""
        with self._database.write() as connection:
            where = tables.sessions.c.token_sha256 == _digest(token)
            connection.execute(sa.update(tables.sessions).where(where).values(revoked_at=now_utc()))
        self._forget(token)

    def _remember(self, token: str, session: Session) -> None:
        with self._remembering:
            self._remembered[_digest(token)] = session
            while len(self._remembered) > MOST_REMEMBERED:
                digest, oldest = next(iter(self._remembered.items()))
                if self._now_s() < oldest.expires_at_s:
                    return
                del self._remembered[digest]

    def _forget(self, token: str) -> None:
        with self._remembering:
            session = self._remembered.pop(_digest(token), None)
        if session is not None:
            self._uses.forget(session.id)

    def _worth_remembering(self, newest_first: Iterable[sa.Row[Any]]) -> Iterator[tuple[str, Session]]:
        for number, row in enumerate(newest_first):
            if number >= MOST_REMEMBERED and self._now_s() >= row.expires_at_s:
                return
            yield row.token_sha256, self._session(row)

    def _set(self, session_id: str, **values: object) -> None:
        with self._database.write() as connection:
            connection.execute(sa.update(tables.sessions).where(tables.sessions.c.id == session_id).values(values))

    def _session(self, row: sa.Row[Any]) -> Session:
        return Session(row.id, row.user_id, row.name, Role(row.role), self._status(row), row.expires_at_s)

    def _status(self, row: sa.Row[Any]) -> SessionStatus:
        now_s = self._now_s()
        if now_s >= row.expires_at_s:
            return SessionStatus.EXPIRED
        pause_s = now_s - self._last_use_s(row)
        # H23: a use that is yet to come was before the clock was put back.
        if row.locked_at is not None or not -_PUT_BACK_S <= pause_s <= self._settings.idle_lock_s:
            return SessionStatus.LOCKED
        return SessionStatus.ACTIVE

    def _last_use_s(self, row: sa.Row[Any]) -> float:
        return self._uses.newest_s(row.id, row.last_seen_at_s)


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()
