"""Databases of every released version, filled: brought up to date they have lost nothing, and the ledger verifies."""

from collections import Counter
from pathlib import Path

import pytest
import sqlalchemy as sa

from service.database import tables
from service.database.engines import open_database
from service.database.migrate import migrate
from service.ledger.anchor import advance_anchor
from service.ledger.keys import public_key, signing_key
from service.ledger.verifying import verify
from tests.databases import ALL

_FOLDER = Path(__file__).parent
_REVISIONS = sorted(file.name.partition(".")[0] for file in _FOLDER.glob("*.sqlite.sql"))


@pytest.fixture(params=_REVISIONS)
def released(request, databases, tmp_path):
    """A database as that version left it, opened by today's program; its public key where it had one."""
    dump = _FOLDER / f"{request.param}.{databases.dialect}.sql"
    key = _FOLDER / f"{request.param}.pem"
    with databases.loaded(dump.read_text(), tmp_path) as address:
        database = open_database(address, signing_key(tmp_path / "signing.key"))
        yield database, [public_key(key)] if key.exists() else []
        database.close()


def _rows(database):
    """Every row of every table by the columns that it has, as text."""
    with database.read() as connection:
        found = sa.MetaData()
        found.reflect(connection)
        return {
            name: ([column.name for column in table.columns], list(connection.execute(sa.select(table))))
            for name, table in found.tables.items()
            if name != "alembic_version"
        }


def test_an_upgrade_loses_and_changes_no_row(released):
    database, _ = released
    before = _rows(database)
    migrate(database)
    after = _rows(database)
    for name, (columns, rows) in before.items():
        now_columns, now = after[name]
        places = [now_columns.index(column) for column in columns]
        kept = Counter(repr([row[place] for place in places]) for row in now)
        assert not Counter(repr(list(row)) for row in rows) - kept, name
        assert name in ("ledger", "checkpoints") or len(now) == len(rows), name
    assert all(before[name][1] for name in ("users", "events", "image_bytes", "verdicts", "motions"))


def test_after_an_upgrade_the_ledger_verifies_and_finds_what_is_changed_later(released, databases, tmp_path):
    database, keys = released
    migrate(database)
    advance_anchor(database, tmp_path / "head.json", database.signer)
    verifiers = {key.name: key for key in (*keys, database.signer.verifier)}
    assert verify(database, verifiers, tmp_path / "head.json").findings == []
    with databases.attack(database.writer.url.set(drivername=databases.dialect).render_as_string()) as attacker:
        attacker.execute("UPDATE events SET state = 'moved' WHERE case_id = 'case-1' AND sequence = 3")
    (finding,) = verify(database, verifiers, tmp_path / "head.json").findings
    assert finding.where == "events case-1/3"


def test_the_newest_release_has_every_table_filled(released):
    """Else an upgrade that loses a table's rows would not be seen; new tables come with the next release."""
    database, _ = released
    filled = {name for name, (_, rows) in _rows(database).items() if rows}
    there = {table.name for table in ALL} & _rows(database).keys()
    assert there <= filled | {table.name for table in tables.MUTABLE}
