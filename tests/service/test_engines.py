"""The traps of databases under SQLAlchemy: lost updates, weak PRAGMAs, readers that write."""

import threading
from contextlib import ExitStack, closing

import pytest
import sqlalchemy as sa
from sqlalchemy.exc import IntegrityError, InternalError

from service.database import engines, tables
from service.database.engines import Database, open_database
from service.errors import ErrorCode, ServiceError

_CLAIM = {"room": "contested", "holder": "0", "claimed_at": ""}


def _increment(database: Database, times: int) -> None:
    claims = tables.room_claims
    for _ in range(times):
        with database.write() as connection:
            holder = connection.execute(sa.select(claims.c.holder).where(claims.c.room == "contested")).scalar_one()
            connection.execute(sa.update(claims).values(holder=str(int(holder) + 1)))


def test_200_contested_increments_lose_none(database):
    with database.write() as connection:
        connection.execute(sa.insert(tables.room_claims).values(_CLAIM))
    threads = [threading.Thread(target=_increment, args=(database, 50)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    with database.read() as connection:
        assert connection.execute(sa.select(tables.room_claims.c.holder)).scalar_one() == "200"


@pytest.mark.hazard("H25")
@pytest.mark.sqlite
@pytest.mark.parametrize("engine", ["writer", "reader"])
def test_every_connection_is_durable(database, engine):
    pool = getattr(database, engine).pool
    connections = [pool.connect() for _ in range(3)]
    for connection in connections:
        pragmas = ("journal_mode", "synchronous", "foreign_keys", "recursive_triggers")
        found = [connection.driver_connection.execute(f"PRAGMA {one}").fetchone()[0] for one in pragmas]
        assert found == ["wal", 2, 1, 1]
        connection.close()


@pytest.mark.hazard("H25")
def test_a_database_that_cannot_do_wal_is_refused():
    with pytest.raises(ServiceError, match="journal_mode") as refusal:
        open_database("sqlite://")
    assert refusal.value.code == ErrorCode.DATABASE_FAULT


def test_the_reader_cannot_write(database):
    fault = (ServiceError, InternalError)  # SQLite's own, PostgreSQL's
    with pytest.raises(fault, match="cannot"), database.read() as connection:
        connection.execute(sa.insert(tables.room_claims).values(_CLAIM))


def test_a_reader_sees_one_moment_while_a_writer_commits(database):
    count = sa.select(sa.func.count()).select_from(tables.room_claims)
    with database.read() as reader:
        before = reader.execute(count).scalar_one()
        with database.write() as writer:
            writer.execute(sa.insert(tables.room_claims).values(_CLAIM))
        assert reader.execute(count).scalar_one() == before
    with database.read() as reader:
        assert reader.execute(count).scalar_one() == before + 1


def _claim_twice(database: Database) -> None:
    with database.write() as connection:
        connection.execute(sa.insert(tables.room_claims).values(_CLAIM))
        connection.execute(sa.insert(tables.room_claims).values(_CLAIM))


def test_an_exception_leaves_nothing_behind_and_wakes_nobody(database):
    woken = []
    database.on_commit.append(lambda: woken.append(True))
    with pytest.raises(IntegrityError):
        _claim_twice(database)
    with database.read() as connection:
        assert connection.execute(sa.select(tables.room_claims)).all() == []
    assert woken == []


@pytest.mark.hazard("H31")
def test_a_text_that_postgresql_does_not_know_is_refused_with_a_type_and_found_nowhere(database):
    claims = tables.room_claims

    def look() -> list:
        with database.read() as connection:
            return connection.execute(sa.select(claims).where(claims.c.room == "a\x00b")).all()

    if database.reader.dialect.name == "sqlite":
        assert look() == []
        return
    with pytest.raises(ServiceError) as refusal:
        look()
    assert refusal.value.code == ErrorCode.MALFORMED_REQUEST


def test_a_folder_that_is_no_database_is_a_typed_fault(tmp_path):
    with pytest.raises(ServiceError) as refusal:
        open_database(f"sqlite:///{tmp_path}")
    assert refusal.value.code == ErrorCode.DATABASE_FAULT


@pytest.mark.hazard("H24")
@pytest.mark.sqlite
def test_a_full_disk_is_a_typed_fault_and_the_rest_stays(database):
    """`max_page_count` makes SQLite answer SQLITE_FULL, as a full disk does."""
    with database.writer.connect() as connection:
        pages = connection.exec_driver_sql("PRAGMA page_count").scalar()
        connection.exec_driver_sql(f"PRAGMA max_page_count={pages}")
    with pytest.raises(ServiceError) as refusal, database.write() as connection:
        connection.execute(sa.insert(tables.image_bytes).values(sha256="x", content=b"0" * 1_000_000))
    assert refusal.value.code == ErrorCode.DISK_FULL
    with database.read() as connection:
        assert connection.execute(sa.select(tables.image_bytes)).all() == []


def test_a_reader_that_finds_every_connection_in_use_is_refused_with_a_code(database, monkeypatch):
    """What records a stop tries again after a refusal; after anything else it would be over."""
    monkeypatch.setitem(engines._OPTIONS, "pool_timeout", 0.01)
    address = database.writer.url.render_as_string(hide_password=False)
    with closing(open_database(address)) as other, ExitStack() as readers, pytest.raises(ServiceError) as refused:
        _read_without_an_end(other, readers)
    assert refused.value.code == ErrorCode.DATABASE_BUSY


def _read_without_an_end(database: Database, readers: ExitStack) -> None:
    for _ in range(50):
        readers.enter_context(database.read())
