"""Proving who one is: password to sign in, PIN at critical steps; too many wrong answers lock out."""

import time
from collections.abc import Callable
from threading import Lock

import sqlalchemy as sa
from limits import RateLimitItemPerSecond
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter
from sqlalchemy.engine import Connection

from service.audit import record_audit
from service.auth.door import Door
from service.auth.session import Session
from service.auth.users import User, UserStore
from service.database import tables
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.settings import SessionSettings


class Proofs:
    """Checks answers, one after the other. Each costs a quarter of a second of hashing: call from a thread.

    Side by side, checks would take the processor from a stop and 64 MiB each, and as many wrong answers as come at
    once would be tried before the first is counted (H27, H32). Who has signed in does not wait for who has not.
    """

    def __init__(
        self,
        database: Database,
        users: UserStore,
        settings: SessionSettings,
        now_s: Callable[[], float] = time.time,
    ) -> None:
        self._database = database
        self._users = users
        self._settings = settings
        self._now_s = now_s
        self._door, self._pins = Door(), Lock()
        self._limiter = MovingWindowRateLimiter(MemoryStorage())
        self._allowance = RateLimitItemPerSecond(settings.wrong_answers, settings.wrong_answers_window_s)

    def sign_in(self, name: str, password: str) -> User:
        """The user with this name and password; ServiceError SIGN_IN_REFUSED, SIGN_IN_BUSY or LOCKED_OUT."""
        return self._signed_in(f"password:{name}", lambda: self._users.with_password(name, password))

    def sign_in_with_pin(self, name: str, pin: str) -> User:
        """The user with this name and PIN; ServiceError SIGN_IN_REFUSED, SIGN_IN_BUSY or LOCKED_OUT.

        SIGN_IN_REFUSED too where the site wants the password: the answer tells nobody which PIN is right.
        """
        allowed = self._settings.pin_sign_in
        return self._signed_in(f"pin-sign-in:{name}", lambda: self._users.with_pin(name, pin) if allowed else None)

    def _signed_in(self, subject: str, prove: Callable[[], User | None]) -> User:
        with self._door.turn():
            self._refuse_locked_out(subject)
            user = prove()
            if user is None:
                self._count_wrong_answer(subject, None)
                raise ServiceError(ErrorCode.SIGN_IN_REFUSED, "name or secret is wrong")
            self._limiter.clear(self._allowance, subject)
            return user

    def confirm_pin(self, session: Session, pin: str) -> None:
        """Return if `pin` is the session's user's; ServiceError PIN_REFUSED or LOCKED_OUT otherwise."""
        subject = f"pin:{session.user_id}"
        with self._pins:
            self._refuse_locked_out(subject)
            if not self._users.pin_matches(session.user_id, pin):
                self._count_wrong_answer(subject, session.user_id)
                raise ServiceError(ErrorCode.PIN_REFUSED, "the PIN is wrong")
            self._limiter.clear(self._allowance, subject)

    def _refuse_locked_out(self, subject: str) -> None:
        query = sa.select(tables.lock_outs.c.until_s).where(tables.lock_outs.c.subject == subject)
        with self._database.read() as connection:
            until_s = connection.execute(query).scalar()
        if until_s is None or until_s <= self._now_s():
            return
        # One that would last twice as long as it should is from before the clock was put back (H23): it begins anew.
        if until_s >= self._now_s() + 2 * self._settings.lock_out_s:
            with self._database.write() as connection:
                until_s = self._lock_out(connection, subject)
        raise ServiceError(ErrorCode.LOCKED_OUT, "too many wrong answers; seconds left", measured=self._left(until_s))

    def _lock_out(self, connection: Connection, subject: str) -> float:
        """From now on, in the database, so that a restart does not open the door again; until when."""
        until_s = self._now_s() + self._settings.lock_out_s
        connection.execute(sa.delete(tables.lock_outs).where(tables.lock_outs.c.subject == subject))
        connection.execute(sa.insert(tables.lock_outs).values(subject=subject, until_s=until_s))
        return until_s

    def _left(self, until_s: float) -> float:
        return round(until_s - self._now_s(), 1)

    def _count_wrong_answer(self, subject: str, user_id: str | None) -> None:
        self._limiter.hit(self._allowance, subject)
        locked = not self._limiter.test(self._allowance, subject)
        with self._database.write() as connection:
            record_audit(connection, "wrong_answer", user_id, {"subject": subject, "locked_out": locked})
            if locked:
                self._lock_out(connection, subject)
        if locked:
            self._limiter.clear(self._allowance, subject)
