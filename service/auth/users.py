"""Users: names, roles, and the argon2 hashes of password and PIN."""

import re
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from uuid import uuid4

import sqlalchemy as sa
from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError
from sqlalchemy.engine import Connection
from sqlalchemy.exc import IntegrityError

from service.audit import record_audit
from service.auth.permissions import Role
from service.database import tables
from service.database.clock import now_utc
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
_PIN = re.compile(r"[0-9]{4,12}")
_PASSWORD_LENGTH = range(8, 257)
_USER_NAME = sa.select(tables.users.c.name).where(tables.users.c.id == sa.bindparam("id"))


@dataclass(frozen=True, slots=True)
class User:
    """A user as others may see one."""

    id: str
    name: str
    role: Role


class UserStore:
    """Users in the database. A hash takes a quarter of a second: call from a thread, never on the event loop."""

    def __init__(self, database: Database, hasher: PasswordHasher | None = None) -> None:
        self._database = database
        self._hasher = hasher or PasswordHasher()

    def add(self, name: str, role: Role, password: str, pin: str) -> User:
        """A new user; ServiceError USER_REFUSED or USER_EXISTS."""
        _check_rules(name, password, pin)
        user = User(uuid4().hex, name, role)
        hashes = {"password_hash": self._hasher.hash(password), "pin_hash": self._hasher.hash(pin)}
        values = {"id": user.id, "name": name, "role": role.value, "created_at": now_utc(), **hashes}
        try:
            with self._database.write() as connection:
                connection.execute(sa.insert(tables.users).values(values))
                record_audit(connection, "user_added", None, {"user_id": user.id, "name": name, "role": role.value})
        except IntegrityError as error:
            raise ServiceError(ErrorCode.USER_EXISTS, f"there is a user {name} already") from error
        return user

    def with_password(self, name: str, password: str) -> User | None:
        """The active user whose name and password these are."""
        return self._proved(name, "password_hash", password)

    def with_pin(self, name: str, pin: str) -> User | None:
        """The active user whose name and PIN these are."""
        return self._proved(name, "pin_hash", pin)

    def _proved(self, name: str, column: str, secret: str) -> User | None:
        with self._database.read() as connection:
            row = _active(connection, tables.users.c.name == name)
        matches = self._matches(row._mapping[column] if row else self._nobody, secret)
        return User(row.id, row.name, Role(row.role)) if row and matches else None

    def pin_matches(self, user_id: str, pin: str) -> bool:
        """Whether this is the PIN of an active user."""
        with self._database.read() as connection:
            row = _active(connection, tables.users.c.id == user_id)
        return self._matches(row.pin_hash if row else self._nobody, pin) and row is not None

    def list(self) -> list[User]:
        """Every active user, by name."""
        users = tables.users
        query = sa.select(users).where(users.c.disabled_at.is_(None)).order_by(users.c.name)
        with self._database.read() as connection:
            return [User(row.id, row.name, Role(row.role)) for row in connection.execute(query)]

    def disable(self, name: str) -> None:
        """End a user's access and every session of theirs; ServiceError USER_UNKNOWN."""
        with self._database.write() as connection:
            row = _active(connection, tables.users.c.name == name)
            if row is None:
                raise ServiceError(ErrorCode.USER_UNKNOWN, f"there is no active user {name}")
            now = now_utc()
            connection.execute(sa.update(tables.users).where(tables.users.c.id == row.id).values(disabled_at=now))
            connection.execute(
                sa.update(tables.sessions).where(tables.sessions.c.user_id == row.id).values(revoked_at=now)
            )
            record_audit(connection, "user_disabled", None, {"user_id": row.id, "name": name})

    @cached_property
    def _nobody(self) -> str:
        """Checked when the name is unknown, so that the time of an answer does not tell which names exist."""
        return self._hasher.hash("nobody has this password")

    def _matches(self, hashed: str, secret: str) -> bool:
        try:
            return self._hasher.verify(hashed, secret)
        except (VerificationError, InvalidHashError):
            return False


def _active(connection: Connection, condition: sa.ColumnElement[bool]) -> sa.Row[Any] | None:
    return connection.execute(sa.select(tables.users).where(condition, tables.users.c.disabled_at.is_(None))).first()


def _check_rules(name: str, password: str, pin: str) -> None:
    if not _NAME.fullmatch(name):
        raise ServiceError(ErrorCode.USER_REFUSED, "a name has 1 to 64 letters, digits, dots, dashes, underscores")
    if len(password) not in _PASSWORD_LENGTH:
        raise ServiceError(ErrorCode.USER_REFUSED, "a password has 8 to 256 characters", measured=len(password))
    if not _PIN.fullmatch(pin):
        raise ServiceError(ErrorCode.USER_REFUSED, "a PIN has 4 to 12 digits", measured=len(pin))


def user_name(connection: Connection, user_id: str) -> str | None:
    """Their name, of a disabled user too; None where there is no such user."""
    return connection.execute(_USER_NAME, {"id": user_id}).scalar()


def user_names(connection: Connection) -> dict[str, str]:
    """The name of every user that there is or was, by id: the record names people by id."""
    return {row.id: row.name for row in connection.execute(sa.select(tables.users.c.id, tables.users.c.name))}
