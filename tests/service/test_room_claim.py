"""One service per room, by a lock that dies with its holder (H19)."""

import os
import signal
import subprocess
import sys
from contextlib import ExitStack

import pytest
import sqlalchemy as sa

from service.database import tables
from service.database.room_claim import room_claim
from service.errors import ErrorCode, ServiceError

_HOLD = """
import sys, time
from service.database.engines import open_database
from service.database.room_claim import room_claim
with room_claim(open_database(sys.argv[1]), "room-1"):
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def other_service(database):
    """Another process that holds the room."""
    command = [sys.executable, "-c", _HOLD, str(database.writer.url)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


@pytest.mark.hazard("H19")
def test_a_second_service_is_refused_and_told_who_has_the_room(database, other_service):
    with ExitStack() as stack, pytest.raises(ServiceError) as refusal:
        stack.enter_context(room_claim(database, "room-1"))
    assert refusal.value.code == ErrorCode.ROOM_CLAIMED
    assert str(other_service.pid) in refusal.value.message


def test_a_killed_service_gives_the_room_up_at_once(database, other_service):
    other_service.kill()
    other_service.wait()
    with room_claim(database, "room-1"):
        pass


@pytest.mark.hazard("H19")
def test_a_stopped_service_keeps_its_room_however_long(database, other_service):
    os.kill(other_service.pid, signal.SIGSTOP)
    with ExitStack() as stack, pytest.raises(ServiceError):
        stack.enter_context(room_claim(database, "room-1"))


def test_the_room_is_free_after_the_block(database):
    with room_claim(database, "room-1"):
        pass
    with room_claim(database, "room-1"):
        pass


@pytest.fixture
def left_elsewhere(database):
    """The row of a workstation that died with the room."""
    with database.write() as connection:
        row = {"room": "room-1", "holder": "process 7 on another", "claimed_at": "2026-01-05T12:00:00.000000Z"}
        connection.execute(sa.insert(tables.room_claims).values(row))


def _holder(database) -> str | None:
    with database.read() as connection:
        return connection.execute(sa.select(tables.room_claims.c.holder)).scalar()


def test_a_room_that_another_workstation_did_not_give_up_is_claimed_only_with_a_reason(database, left_elsewhere):
    with ExitStack() as stack, pytest.raises(ServiceError) as refusal:
        stack.enter_context(room_claim(database, "room-1"))
    assert refusal.value.code == ErrorCode.ROOM_LEFT
    assert "process 7 on another" in refusal.value.message
    with room_claim(database, "room-1", "its power supply burnt"):
        assert str(os.getpid()) in _holder(database)
    with database.read() as connection:
        [event] = connection.execute(sa.select(tables.audit_events).where(tables.audit_events.c.kind == "room_claimed"))
    assert event.data["left_by"] == "process 7 on another"
    assert event.data["reason"] == "its power supply burnt"


def test_a_room_that_was_given_up_or_left_here_needs_no_reason(database):
    with room_claim(database, "room-1"):
        held = _holder(database)
    assert _holder(database) is None
    with database.write() as connection:  # as a kill leaves it
        connection.execute(sa.insert(tables.room_claims).values(room="room-1", holder=held, claimed_at=""))
    with room_claim(database, "room-1"):
        pass
