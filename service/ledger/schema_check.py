"""Compares the schema with the one that the migrations make: tables, indices, and the triggers that refuse changes.

By the text that SQLite keeps of every object: an upgraded database has the same as a new one, which runs the same
migrations. PostgreSQL keeps no text, and could say what the migrations make only by running them, which a verification
that writes nothing cannot: there the schema is not compared.
"""

from collections import Counter
from functools import cache
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database.engines import Database
from service.database.json_text import to_text
from service.database.migrate import migrate
from service.ledger.findings import Verification

# Where their pages are is left out: that differs, and whoever looks at rows and indices comes by it.
_OBJECTS = sa.text("SELECT type, name, tbl_name, sql FROM sqlite_schema")
_Object = tuple[Any, ...]  # of a damaged file, any kind of value


def check_schema(connection: Connection, verification: Verification) -> None:
    """Every object is there, as the migrations make it, and there is no other."""
    if connection.dialect.name != "sqlite":
        return
    there, made = _objects(connection), _made()
    missing, other = made - there, there - made
    known, left = _names(made), _names(there)
    for one in missing:
        if one[:2] not in left:
            verification.find(_shown(one), "missing in the schema: dropped, or its name changed")
    for one in other:
        what = "not as the migrations make it: changed" if one[:2] in known else "made by no migration"
        verification.find(_shown(one), what)


@cache
def _made() -> Counter[_Object]:
    """What this program's migrations make, once a process: that takes longer than to look at a small record."""
    engine = sa.create_engine("sqlite://", json_serializer=to_text)
    try:
        migrate(Database(engine, engine))
        with engine.connect() as connection:
            return _objects(connection)
    finally:
        engine.dispose()


def _objects(connection: Connection) -> Counter[_Object]:
    return Counter(connection.execute(_OBJECTS).cursor.fetchall())


def _names(objects: Counter[_Object]) -> set[_Object]:
    return {one[:2] for one in objects}


def _shown(one: _Object) -> str:
    kind, name, *_ = one
    return f"{kind} {name}"
