"""The schema: what the migrations make is what the tables say; an upgrade happens whole or not at all."""

import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy.dialects import postgresql
from sqlalchemy.schema import CreateTable

from service.database.engines import open_database
from service.database.migrate import migrate
from service.database.tables import metadata
from service.errors import ErrorCode, ServiceError


@pytest.fixture
def empty(databases, tmp_path):
    with databases.empty(tmp_path) as address:
        database = open_database(address)
        yield database
        database.close()


def _revision(database) -> str | None:
    with database.read() as connection:
        return MigrationContext.configure(connection).get_current_revision()


def test_the_migrated_schema_is_the_tables(database):
    with database.read() as connection:
        assert compare_metadata(MigrationContext.configure(connection), metadata) == []


def test_migrating_twice_changes_nothing(database):
    before = _revision(database)
    migrate(database)
    assert _revision(database) == before is not None


def test_an_upgrade_that_fails_at_its_end_leaves_an_empty_database(empty, monkeypatch):
    def broken(_tables: object) -> None:
        raise RuntimeError("pulled plug")

    monkeypatch.setattr("migrations.append_only.make_append_only", broken)
    with pytest.raises(RuntimeError, match="pulled plug"):
        migrate(empty)
    with empty.read() as connection:
        assert sa.inspect(connection).get_table_names() == []
    monkeypatch.undo()
    migrate(empty)
    assert _revision(empty) is not None


def test_a_database_of_a_newer_program_is_refused(database):
    with database.write() as connection:
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(ServiceError) as refusal:
        migrate(database)
    assert refusal.value.code == ErrorCode.SCHEMA_UNKNOWN


@pytest.mark.parametrize("table", metadata.sorted_tables, ids=lambda table: table.name)
def test_every_table_can_be_written_for_postgresql(table):
    assert "CREATE TABLE" in str(CreateTable(table).compile(dialect=postgresql.dialect()))
