"""The same code on PostgreSQL: a real server of its own, where Debian's `postgresql` is installed."""

import threading
from contextlib import ExitStack

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy.exc import DBAPIError

from service.auth.permissions import Role
from service.auth.users import UserStore
from service.cases import store
from service.cases.records import NewCase, NewEvent
from service.database.engines import open_database
from service.database.migrate import migrate
from service.database.room_claim import room_claim
from service.database.tables import metadata
from service.errors import ErrorCode, ServiceError

_EVENT = NewEvent("noted", None, "case_open", {"rms": float("nan")}, {})


@pytest.fixture(scope="module")
def server(postgresql_address):
    """The migrated database with one case in it."""
    database = open_database(postgresql_address)
    migrate(database)
    surgeon = UserStore(database).add("anna", Role.SURGEON, "correct horse", "2468")
    with database.write() as connection:
        store.open_case(connection, NewCase("case-1", "room-1", "P1", "1", surgeon.id, "0" * 64, {}, {}), _EVENT)
    yield database
    database.close()


def _append(database, times: int) -> None:
    for _ in range(times):
        with database.write() as connection:
            before = store.newest_event(connection, "case-1")
            store.append(connection, "case-1", _EVENT, expected_version=before.version)


def test_the_migrated_schema_is_the_tables(server):
    with server.read() as connection:
        assert compare_metadata(MigrationContext.configure(connection), metadata) == []


def test_200_contested_appends_lose_none_and_none_is_refused(server):
    with server.read() as connection:
        before = store.newest_event(connection, "case-1").sequence
    threads = [threading.Thread(target=_append, args=(server, 50)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    with server.read() as connection:
        assert store.newest_event(connection, "case-1").sequence == before + 200


@pytest.mark.parametrize("change", ["UPDATE events SET state = 'x'", "DELETE FROM events", "TRUNCATE events CASCADE"])
def test_a_record_cannot_be_changed(server, change):
    with pytest.raises(DBAPIError, match="append-only"), server.write() as connection:
        connection.exec_driver_sql(change)


def test_the_reader_cannot_write(server):
    with pytest.raises(DBAPIError, match="read-only"), server.read() as connection:
        connection.exec_driver_sql("CREATE TABLE smuggled (number int)")


def test_two_rooms_share_a_database_and_one_room_is_not_shared(server, postgresql_address):
    other = open_database(postgresql_address)
    with room_claim(server, "room-1"), ExitStack() as stack:
        stack.enter_context(room_claim(other, "room-2"))
        with pytest.raises(ServiceError) as refusal:
            stack.enter_context(room_claim(other, "room-1"))
    assert refusal.value.code == ErrorCode.ROOM_CLAIMED
    with room_claim(other, "room-1"):
        pass
    other.close()
