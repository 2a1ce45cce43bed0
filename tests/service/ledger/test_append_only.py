"""Records refuse UPDATE, DELETE and REPLACE, whoever asks; the mutable tables are the ones named so."""

from contextlib import closing

import psycopg
import pytest
import sqlalchemy as sa
from sqlalchemy.exc import DBAPIError

from service.audit import record_audit
from service.database import tables
from tests.databases import ALL


def test_every_table_is_a_record_or_mutable_or_the_ledger():
    groups = (*tables.RECORDS, *tables.LEDGER, *tables.MUTABLE)
    assert {*groups} == set(tables.metadata.tables.values())
    assert len({*groups}) == len(groups)


@pytest.mark.hazard("H26")
@pytest.mark.parametrize("table", ALL, ids=str)
@pytest.mark.parametrize("change", ["UPDATE {table} SET {column} = {column}", "DELETE FROM {table}"])
def test_every_record_table_refuses_every_change(record, table, change):
    statement = change.format(table=table.name, column=table.columns[0].name)
    with (
        closing(record.open()) as database,
        pytest.raises(DBAPIError, match="append-only"),
        database.write() as connection,
    ):
        connection.exec_driver_sql(statement)


def test_no_record_table_is_emptied_on_postgresql(postgresql, tmp_path):
    with postgresql.migrated(tmp_path) as address, psycopg.connect(address, autocommit=True) as connection:
        for table in ALL:
            with pytest.raises(psycopg.errors.RaiseException, match="append-only"):
                connection.execute(f"TRUNCATE {table.name} CASCADE")


@pytest.mark.parametrize(
    "statement",
    [
        pytest.param(
            "REPLACE INTO audit_events (id, kind, data, recorded_at) VALUES (1, 'forged', '{}', '')",
            marks=pytest.mark.sqlite,
        ),
        "INSERT INTO audit_events (id, kind, data, recorded_at) VALUES (1, 'forged', '{}', '') "
        "ON CONFLICT (id) DO UPDATE SET kind = 'forged'",
    ],
)
def test_no_other_way_of_writing_changes_a_record(database, statement):
    with database.write() as connection:
        record_audit(connection, "true", None, {})
    with pytest.raises(DBAPIError, match="append-only"), database.write() as connection:
        connection.exec_driver_sql(statement)
    with database.read() as connection:
        assert connection.execute(sa.select(tables.audit_events.c.kind)).scalars().all() == ["true"]
