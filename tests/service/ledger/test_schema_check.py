"""A schema that is not what the migrations make is found, and each object that differs is named."""

import sqlite3
from contextlib import closing

import pytest

from tests.databases import ALL, file_of

pytestmark = pytest.mark.sqlite

_CHANGES = ("update", "delete")
_TRIGGERS = [f"{table.name}_refuse_{change}" for table in ALL for change in _CHANGES]


def _alter(record, *statements):
    with closing(sqlite3.connect(file_of(record.address))) as connection, connection:
        for statement in statements:
            connection.execute(statement)


def _said(record):
    return {finding.where: finding.what for finding in record.findings()}


@pytest.mark.hazard("H26")
@pytest.mark.parametrize("trigger", _TRIGGERS)
def test_a_dropped_trigger_is_named(record, trigger):
    _alter(record, f"DROP TRIGGER {trigger}")
    ((where, what),) = _said(record).items()
    assert where == f"trigger {trigger}"
    assert what.startswith("missing")


@pytest.mark.hazard("H26")
def test_a_trigger_that_refuses_nothing_any_more_is_named(record):
    name = "events_refuse_update"
    _alter(record, f"DROP TRIGGER {name}", f"CREATE TRIGGER {name} BEFORE UPDATE ON events BEGIN SELECT 1; END")
    ((where, what),) = _said(record).items()
    assert where == f"trigger {name}"
    assert what.endswith("changed")


@pytest.mark.parametrize(
    ("statement", "where"),
    [
        ("CREATE TRIGGER forge AFTER INSERT ON users BEGIN DELETE FROM sessions; END", "trigger forge"),
        ("CREATE TABLE forged (id INTEGER)", "table forged"),
        ("CREATE INDEX forged ON events (state)", "index forged"),
        ("CREATE VIEW forged AS SELECT * FROM events", "view forged"),
    ],
)
def test_what_no_migration_makes_is_named(record, statement, where):
    _alter(record, statement)
    assert _said(record) == {where: "made by no migration"}


def test_a_dropped_index_is_named(record):
    _alter(record, "DROP INDEX ix_events_over")
    assert set(_said(record)) == {"index ix_events_over"}


@pytest.mark.hazard("H26")
@pytest.mark.parametrize(
    ("table", "before", "after"),
    [
        ("users", "pin_hash VARCHAR", "pin_haph VARCHAR"),  # as one flipped bit leaves it, where no row is compared
        ("users", "pin_hash VARCHAR", "pin_ha\xffh VARCHAR"),  # no UTF-8 any more
        ("checkpoints", "statement TEXT", "state\xeeent TEXT"),  # nor is such a column, however text is read
        ("events", "state VARCHAR NOT NULL", "state VARCHAR"),  # every row stays as it is
        ("checkpoints", "REFERENCES ledger", "REFERENCES ladger"),
    ],
)
def test_a_table_whose_text_was_changed_is_named(record, table, before, after):
    changed = "UPDATE sqlite_schema SET sql = CAST(replace(CAST(sql AS BLOB), ?, ?) AS TEXT) WHERE name = ? RETURNING 1"
    with closing(sqlite3.connect(file_of(record.address))) as connection, connection:
        connection.execute("PRAGMA writable_schema = ON")
        values = (before.encode(), after.encode("latin-1"), table)
        assert connection.execute(changed, values).fetchall()
    assert _said(record)[f"table {table}"].endswith("changed")
