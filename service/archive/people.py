"""The people of an imported case: their ids and names, and nothing to sign in with."""

from collections.abc import Mapping
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.database.clock import now_utc

_LONGEST_NAME = 64
_NOTHING = ""  # no hash: no password and no PIN is right


def add_missing_people(connection: Connection, people: Mapping[str, Any], case_id: str) -> None:
    """Add those who are not here; disabled, and by a name that none of this workstation's users has."""
    users = tables.users
    for user_id, person in sorted(people.items()):
        if connection.execute(sa.select(users.c.id).where(users.c.id == user_id)).first() is not None:
            continue
        name, now = f"{person['name']} (imported {case_id[:8]} {user_id[:8]})"[-_LONGEST_NAME:], now_utc()
        values = {"id": user_id, "name": name, "role": person["role"], "created_at": now, "disabled_at": now}
        connection.execute(sa.insert(users).values(password_hash=_NOTHING, pin_hash=_NOTHING, **values))
