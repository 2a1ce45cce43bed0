"""Records refuse UPDATE, DELETE and REPLACE, whoever asks; the mutable tables are the ones named so."""

import pytest
import sqlalchemy as sa
from sqlalchemy.exc import IntegrityError

from service.audit import record_audit
from service.database import tables


def test_every_table_is_a_record_or_mutable_or_the_ledger():
    groups = (*tables.RECORDS, *tables.LEDGER, *tables.MUTABLE)
    assert {*groups} == set(tables.metadata.tables.values())
    assert len({*groups}) == len(groups)


@pytest.mark.parametrize("table", [*tables.RECORDS, *tables.LEDGER], ids=lambda table: table.name)
@pytest.mark.parametrize("change", ["UPDATE", "DELETE"])
def test_every_record_table_has_its_triggers(database, table, change):
    query = sa.text("SELECT sql FROM sqlite_master WHERE type = 'trigger' AND tbl_name = :table")
    with database.read() as connection:
        triggers = connection.execute(query, {"table": table.name}).scalars().all()
    assert any(f"BEFORE {change} ON {table.name}" in trigger for trigger in triggers)


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE audit_events SET kind = 'forged'",
        "DELETE FROM audit_events",
        "REPLACE INTO audit_events (id, kind, data, recorded_at) VALUES (1, 'forged', '{}', '')",
        "INSERT INTO audit_events (id, kind, data, recorded_at) VALUES (1, 'forged', '{}', '') "
        "ON CONFLICT (id) DO UPDATE SET kind = 'forged'",
    ],
)
def test_a_record_cannot_be_changed(database, statement):
    with database.write() as connection:
        record_audit(connection, "true", None, {})
    with pytest.raises(IntegrityError, match="append-only"), database.write() as connection:
        connection.exec_driver_sql(statement)
    with database.read() as connection:
        assert connection.execute(sa.select(tables.audit_events.c.kind)).scalars().all() == ["true"]
