"""What only PostgreSQL is asked: many rooms on one server."""

from contextlib import ExitStack
from threading import Timer

import pytest

from coaxial_client import Coaxial, Refused
from service.database.engines import open_database
from service.database.room_claim import room_claim
from service.errors import ErrorCode, ServiceError
from service.ledger.keys import signing_key
from service.ledger.verifying import verify
from service.settings import DicomSettings, HttpSettings, Settings

# A server that is busy sees the connection of a holder that has ended so late.
_GONE_LATE_S = 0.25


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


def test_a_holder_whose_connection_closes_a_moment_later_is_waited_for(opened):
    one, other = opened(), opened()
    with ExitStack() as held:
        held.enter_context(room_claim(one, "room-1"))
        ending = Timer(_GONE_LATE_S, held.close)
        ending.start()
        with room_claim(other, "room-1"):
            pass
        ending.join()


@pytest.fixture
def rooms(postgresql, tmp_path, serving, device_files):
    """Two services on one database, each with a surgeon signed in."""
    with postgresql.empty(tmp_path) as address, ExitStack() as stack:

        def enter(room):
            folder = tmp_path / room
            folder.mkdir()
            ports = {"http": HttpSettings(port=0), "dicom": DicomSettings(port=0)}
            settings = Settings(room=room, data_folder=folder, database_url=address, min_free_bytes=0, **ports)
            signing_key(settings.key_file)  # `coaxial audit key --new`: the second of a record that another one signs
            service = stack.enter_context(serving(settings))
            client = stack.enter_context(Coaxial(service.url))
            client.sign_in("surgeon", "correct horse")
            return service, client

        one, other = enter("room-1"), enter("room-2")
        for kind, content in device_files.items():
            one[1].upload_device(kind, content.encode())
        yield one, other


def test_two_services_on_one_database_keep_their_rooms_apart(rooms):
    (one, surgeon), (other, colleague) = rooms
    target = {"name": "L3", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}
    mine, theirs = (
        room.open_case({"patient_id": patient, "study_uid": "1.2.3", "targets": [target]})
        for room, patient in ((surgeon, "P1"), (colleague, "P2"))
    )
    assert [room.get("/status")["open_case"] for room in (surgeon, colleague)] == [mine.id, theirs.id]
    for command, said in (("note", {"text": "whose?"}), ("case-aborted", {"reason": "whose?"})):
        with pytest.raises(Refused) as refused:
            colleague.case(mine.id).command(command, **said)
        assert (refused.value.code, refused.value.measured) == (ErrorCode.CASE_ELSEWHERE, "room-1")
    assert colleague.post("/stop", {}, {})["recorded"]
    assert [case.status()["state"] for case in (mine, theirs)] == ["case_open", "safe_hold"]
    mine.command("note", text="mine")
    verifiers = {key.name: key for key in (_verifier(one), _verifier(other))}
    assert verify(one.parts.database, verifiers, other.parts.settings.anchor_file).findings == []


def _verifier(service):
    return service.parts.database.signer.verifier
