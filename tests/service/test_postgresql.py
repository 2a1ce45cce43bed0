"""What only PostgreSQL is asked: many rooms on one server."""

from contextlib import ExitStack

import pytest

from service.database.engines import open_database
from service.database.room_claim import room_claim
from service.errors import ErrorCode, ServiceError


@pytest.fixture
def opened(postgresql, tmp_path):
    """Opens the same database again, as another service does."""
    with postgresql.migrated(tmp_path) as address, ExitStack() as stack:

        def open_again():
            database = open_database(address)
            stack.callback(database.close)
            return database

        yield open_again


def test_two_rooms_share_a_database_and_one_room_is_not_shared(opened):
    one, other = opened(), opened()
    with room_claim(one, "room-1"), ExitStack() as stack:
        stack.enter_context(room_claim(other, "room-2"))
        with pytest.raises(ServiceError) as refusal:
            stack.enter_context(room_claim(other, "room-1"))
    assert refusal.value.code == ErrorCode.ROOM_CLAIMED
    with room_claim(other, "room-1"):
        pass
