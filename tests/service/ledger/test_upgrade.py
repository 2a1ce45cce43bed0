"""A database of before the ledger: its rows are taken in, and their entries say so."""

import json
import shutil
import sqlite3

import pytest
import sqlalchemy as sa

from service.database import tables
from service.database.engines import open_database
from service.database.migrate import migrate
from service.ledger.anchor import advance_anchor
from service.ledger.beginning import TAKEN_IN


@pytest.fixture
def upgraded(record, tmp_path):
    """The kept record's rows, put into a database of the first schema, which is then brought up to date."""
    filled = shutil.move(record.file, tmp_path / "filled.sqlite")
    database = open_database(f"sqlite:///{record.file}", record.signer)
    migrate(database, "0001")
    with sqlite3.connect(record.file) as connection:
        connection.execute("ATTACH ? AS filled", [str(filled)])
        for table in ("users", *(table.name for table in tables.RECORDS)):
            connection.execute(f"INSERT INTO {table} SELECT * FROM filled.{table}")
    connection.close()
    migrate(database)
    record.anchor.unlink()
    advance_anchor(database, record.anchor, record.signer)
    database.close()
    return record


def test_every_row_is_vouched_for_and_marked_as_older(upgraded):
    assert upgraded.findings() == []
    with sqlite3.connect(upgraded.file) as connection:
        entries = [json.loads(text) for (text,) in connection.execute("SELECT entry FROM ledger ORDER BY sequence")]
        counts = {t.name: connection.execute(f"SELECT count(*) FROM {t.name}").fetchone()[0] for t in tables.RECORDS}
    connection.close()
    assert min(counts.values()) > 0
    assert {entry["action"] for entry in entries[1:]} == {TAKEN_IN}
    assert all("not for the time before" in entry["payload"]["marker"] for entry in entries[1:])
    assert {name for entry in entries for name in entry["rows"]} == counts.keys()


@pytest.mark.parametrize("table", tables.RECORDS, ids=lambda table: table.name)
def test_from_then_on_a_deletion_is_found(upgraded, table):
    upgraded.attack(
        lambda c: c.execute(f"DELETE FROM {table.name} WHERE rowid = (SELECT min(rowid) FROM {table.name})")
    )
    (where,) = upgraded.wheres()
    assert where.startswith(f"{table.name} ")


def test_a_ledger_that_was_emptied_is_not_begun_again(record):
    """Else whoever empties it would have the next start vouch for anything."""
    record.attack(lambda c: (c.execute("DELETE FROM checkpoints"), c.execute("DELETE FROM ledger")))
    database = record.open()
    migrate(database)
    with database.read() as connection:
        assert connection.execute(sa.select(sa.func.count()).select_from(tables.ledger)).scalar() == 0
    database.close()
