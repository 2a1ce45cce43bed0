"""`coaxial db`: upgrade, rights, backup and restore, on either database."""

import sqlite3
from contextlib import ExitStack, closing

import psycopg
import pytest
import sqlalchemy as sa
from typer.testing import CliRunner

from service.audit import record_audit
from service.auth.permissions import Role
from service.cli.db import db
from service.database import tables
from service.database.engines import open_database
from service.database.migrate import migrate, version_of
from service.errors import ErrorCode, ServiceError
from tests.databases import ALL


@pytest.fixture
def run(tmp_path, monkeypatch):
    """The command on a database."""
    monkeypatch.setenv("COAXIAL_MIN_FREE_BYTES", "0")

    def on(address, *arguments):
        monkeypatch.setenv("COAXIAL_DATABASE_URL", address)
        return CliRunner().invoke(db, [*arguments, "--data-folder", str(tmp_path)])

    return on


@pytest.fixture
def address(database, users):
    """A database with something in it, left by the service."""
    users.add("anna", Role.SURGEON, "correct horse", "2468")
    with database.write() as connection:
        record_audit(connection, "noted", None, {"text": "µ", "value": 0.1234567})
    database.close()
    return str(database.writer.url)


def _rows(address):
    with closing(open_database(address)) as database, database.read() as connection:
        return {table.name: list(connection.execute(sa.select(table))) for table in tables.metadata.sorted_tables}


def test_a_backup_brings_every_row_back_into_an_empty_database(run, address, databases, tmp_path):
    backup, other = tmp_path / "backup", tmp_path / "other"
    other.mkdir()
    assert run(address, "backup", str(backup)).exit_code == 0
    assert not list(tmp_path.glob(".backup.*"))
    with databases.empty(other) as empty:
        assert run(empty, "restore", str(backup)).exit_code == 0
        rows = _rows(empty)
        assert [row.kind for row in rows["audit_events"]] == ["user_added", "noted", "backed_up"]
        assert rows == _rows(address)
        restored = open_database(empty)
        with pytest.raises(sa.exc.DBAPIError, match="append-only"), restored.write() as connection:
            connection.exec_driver_sql("DELETE FROM audit_events")
        restored.close()


def test_a_backup_of_an_older_version_is_a_copy_and_no_upgrade(run, address, tmp_path):
    with closing(open_database(address)) as database, database.write() as connection:
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = '0001'")
    before = _rows(address)
    told = run(address, "backup", str(tmp_path / "backup"))
    assert (told.exit_code, told.stderr.split(":")[0]) == (0, "of version 0001")
    assert _rows(address) == before
    with closing(open_database(address)) as database:
        assert version_of(database) == "0001"


def test_a_backup_is_its_owner_s_alone_and_none_is_made_of_nothing(run, address, databases, tmp_path):
    assert run(address, "backup", str(tmp_path / "backup")).exit_code == 0
    assert (tmp_path / "backup").stat().st_mode & 0o077 == 0
    nowhere = run(address, "backup", str(tmp_path / "none" / "backup"))
    assert (nowhere.exit_code, nowhere.stderr.split(":")[0]) == (3, ErrorCode.BACKUP_REFUSED)
    assert f"{tmp_path / 'none' / 'backup'} cannot be written" in nowhere.stderr
    other = tmp_path / "other"
    other.mkdir()
    with databases.empty(other) as empty:
        nothing = run(empty, "backup", str(tmp_path / "of-nothing"))
    assert (nothing.exit_code, nothing.stderr.split(":")[0]) == (3, ErrorCode.DATABASE_MISSING)
    assert not (tmp_path / "of-nothing").exists()


def test_nothing_is_written_over(run, address, tmp_path):
    backup = tmp_path / "backup"
    backup.write_text("kept")
    refused = run(address, "backup", str(backup))
    assert (refused.exit_code, refused.stderr.split(":")[0]) == (3, ErrorCode.BACKUP_REFUSED)
    assert backup.read_text() == "kept"
    assert run(address, "backup", str(tmp_path / "whole")).exit_code == 0
    before = _rows(address)
    for file in ("whole", "missing"):
        refused = run(address, "restore", str(tmp_path / file))
        assert (refused.exit_code, refused.stderr.split(":")[0]) == (3, ErrorCode.BACKUP_REFUSED)
    assert _rows(address) == before


def test_a_damaged_backup_leaves_the_database_empty(run, databases, address, tmp_path):
    backup, other = tmp_path / "backup", tmp_path / "other"
    other.mkdir()
    run(address, "backup", str(backup))
    content = bytearray(backup.read_bytes())
    content[len(content) // 2 :] = bytes(len(content) - len(content) // 2)
    backup.write_bytes(content)
    with databases.empty(other) as empty:
        refused = run(empty, "restore", str(backup))
        assert (refused.exit_code, refused.stderr.split(":")[0]) == (3, ErrorCode.BACKUP_REFUSED)
        assert not list(other.iterdir()), "what is no backup leaves no database behind"
        with closing(open_database(empty)) as database, database.read() as connection:
            assert sa.inspect(connection).get_table_names() == []


@pytest.mark.parametrize("statement", ["VACUUM", "CREATE TABLE bookmarks (url TEXT)"], ids=["empty", "another's"])
def test_a_file_without_a_record_is_not_restored(run, databases, tmp_path, statement):
    """To SQLite a file that lost all its bytes is a sound database."""
    backup, other = tmp_path / "backup", tmp_path / "other"
    other.mkdir()
    with closing(sqlite3.connect(backup)) as connection:
        connection.execute(statement)
    with databases.empty(other) as empty:
        refused = run(empty, "restore", str(backup))
        assert (refused.exit_code, refused.stderr.split(":")[0]) == (3, ErrorCode.BACKUP_REFUSED)
        with closing(open_database(empty)) as database, database.read() as connection:
            assert sa.inspect(connection).get_table_names() == []


def test_an_upgrade_makes_an_empty_database_ready_and_a_newer_one_is_refused(run, databases, tmp_path):
    with databases.empty(tmp_path) as empty:
        assert "at version 0" in run(empty, "upgrade").stdout
        with closing(open_database(empty)) as database, database.write() as connection:
            connection.exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
        refused = run(empty, "upgrade")
        assert refused.exit_code == 3
        assert refused.stderr.startswith("schema_unknown: the database was written by a newer version")
        assert "Start the version that wrote" in refused.stderr


@pytest.fixture
def as_service(run, postgresql, tmp_path):
    """A database of a role of its own, upgraded by its owner, as the service's role opens it."""
    with postgresql.empty(tmp_path) as owner, ExitStack() as stack:
        with psycopg.connect(owner) as connection:
            connection.execute("DROP ROLE IF EXISTS service_role")
            connection.execute("CREATE ROLE service_role LOGIN")
        result = run(owner, "upgrade", "--role", "service_role")
        assert result.exit_code == 0, result.output
        database = open_database(owner.replace("coaxial@", "service_role@"))
        stack.callback(database.close)
        yield database, owner


def test_the_service_s_role_adds_records_and_may_change_none(as_service):
    database, owner = as_service
    migrate(database)  # as at every start
    with database.write() as connection:
        record_audit(connection, "noted", None, {})
        connection.execute(sa.insert(tables.lock_outs).values(subject="x", until_s=1.0))
        connection.execute(sa.delete(tables.lock_outs))
    with psycopg.connect(owner.replace("coaxial@", "service_role@"), autocommit=True) as connection:
        for table in ALL:
            first = table.columns[0].name
            for change in (f"UPDATE {table} SET {first} = {first}", f"DELETE FROM {table}", f"TRUNCATE {table}"):
                with pytest.raises(psycopg.errors.InsufficientPrivilege):
                    connection.execute(change)
        with pytest.raises(psycopg.errors.InsufficientPrivilege):
            connection.execute("DROP TRIGGER events_append_only ON events")


def test_the_service_s_role_may_back_up(as_service, run, tmp_path):
    _, owner = as_service
    result = run(owner.replace("coaxial@", "service_role@"), "backup", str(tmp_path / "copy"))
    assert result.exit_code == 0, result.output


def test_a_role_that_may_not_upgrade_says_who_may(as_service):
    database, owner = as_service
    with psycopg.connect(owner) as connection:
        connection.execute("UPDATE alembic_version SET version_num = '0002'")
        connection.execute("DROP TABLE deliveries, outgoing_objects")
    with pytest.raises(ServiceError) as refusal:
        migrate(database)
    assert (refusal.value.code, refusal.value.measured) == (ErrorCode.SCHEMA_OLD, "0002")
