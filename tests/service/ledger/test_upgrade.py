"""A database of before the ledger: its rows are taken in, and their entries say so."""

import dataclasses
import json
from contextlib import closing

import pytest
import sqlalchemy as sa

from service.database import tables
from service.database.migrate import migrate
from service.ledger.anchor import advance_anchor
from service.ledger.beginning import TAKEN_IN

# What later versions brought no old database holds.
_LATER = ("image_assignments", "outgoing_objects", "deliveries")
_OF_THE_FIRST = tuple(table for table in tables.RECORDS if table.name not in _LATER)


@pytest.fixture
def upgraded(record, databases, tmp_path):
    """The kept record's rows, put into a database of the first schema, which is then brought up to date."""
    folder = tmp_path / "upgraded"
    folder.mkdir()
    with databases.empty(folder) as address:
        first = dataclasses.replace(record, folder=folder, address=address)
        with closing(first.open()) as database:
            migrate(database, "0001")
            with closing(record.open()) as filled, filled.read() as source, database.writer.begin() as connection:
                for table in (tables.users, *_OF_THE_FIRST):
                    connection.execute(sa.insert(table), [row._asdict() for row in source.execute(sa.select(table))])
            migrate(database)
            advance_anchor(database, first.anchor, record.signer)
        yield first


def test_every_row_is_vouched_for_and_marked_as_older(upgraded):
    assert upgraded.findings() == []
    rows = upgraded.rows()
    entries = [json.loads(row.entry) for row in sorted(rows["ledger"])]
    assert min(len(rows[table.name]) for table in _OF_THE_FIRST) > 0
    assert {entry["action"] for entry in entries[1:]} == {TAKEN_IN}
    assert all("not for the time before" in entry["payload"]["marker"] for entry in entries[1:])
    assert {name for entry in entries for name in entry["rows"]} == {table.name for table in _OF_THE_FIRST}


@pytest.mark.parametrize("table", _OF_THE_FIRST, ids=lambda table: table.name)
def test_from_then_on_a_deletion_is_found(upgraded, table):
    upgraded.attack(
        lambda c: c.execute(f"DELETE FROM {table.name} WHERE rowid = (SELECT min(rowid) FROM {table.name})")
    )
    (where,) = upgraded.wheres()
    assert where.startswith(f"{table.name} ")


def test_a_ledger_that_was_emptied_is_not_begun_again(record):
    """Else whoever empties it would have the next start vouch for anything."""
    record.attack(lambda c: (c.execute("DELETE FROM checkpoints"), c.execute("DELETE FROM ledger")))
    with closing(record.open()) as database:
        migrate(database)
    assert record.rows()["ledger"] == []
