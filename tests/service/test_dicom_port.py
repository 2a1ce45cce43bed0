"""The DICOM port beside peers that connect and say nothing, or half of it, or too much (H31)."""

import socket
import struct
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import pytest
from pynetdicom import AE
from pynetdicom.association import Association
from pynetdicom.sop_class import Verification
from structlog.testing import capture_logs

from service.images import dicom_port
from service.images.arrivals import ImageArrivals
from service.images.receiver import DicomReceiver
from service.settings import DicomSettings

pytestmark = pytest.mark.hazard("H31")
_MOST = 4
_HALF_A_REQUEST = struct.pack(">BBL", 1, 0, 200) + bytes(20)


@pytest.fixture
def port(database, monkeypatch) -> Iterator[int]:
    monkeypatch.setattr(dicom_port, "MOST_CONNECTIONS", _MOST)
    settings = DicomSettings(port=0, accepted_callers=("CARM",))
    with DicomReceiver(settings, database, ImageArrivals(), lambda: None).listening() as number:
        yield number


@contextmanager
def _associated(port: int) -> Iterator[Association]:
    entity = AE("CARM")
    entity.add_requested_context(Verification)
    association = entity.associate("127.0.0.1", port)
    try:
        yield association
    finally:
        association.release()


@pytest.fixture
def strangers(port):
    """Connections on which some bytes were sent, closed at the end."""
    with ExitStack() as stack:

        def connect(count: int, said: bytes = b"") -> list[socket.socket]:
            peers = [stack.enter_context(socket.create_connection(("127.0.0.1", port), 20)) for _ in range(count)]
            for peer in peers:
                peer.sendall(said)
            return peers

        yield connect


def _is_hung_up(peer: socket.socket) -> bool:
    try:
        return peer.recv(1) == b""
    except ConnectionResetError:
        return True


@pytest.mark.parametrize("said", [b"", _HALF_A_REQUEST], ids=["nothing", "half a request"])
def test_a_carm_comes_in_and_stays_however_many_strangers_there_are(port, strangers, said):
    with _associated(port) as early:
        waiting = strangers(3 * _MOST, said)
        with _associated(port) as late:
            assert [one.send_c_echo().Status for one in (early, late)] == [0, 0]
        assert all(_is_hung_up(one) for one in waiting[: 2 * _MOST])


@pytest.mark.parametrize("said", [b"", _HALF_A_REQUEST], ids=["nothing", "half a request"])
def test_who_asks_for_no_association_is_hung_up_on(port, strangers, said, monkeypatch):
    monkeypatch.setattr(dicom_port, "INTRODUCED_WITHIN_S", 0.2)
    (peer,) = strangers(1, said)
    assert _is_hung_up(peer)
    with _associated(port) as later:
        assert later.is_established


def test_where_all_are_known_the_next_one_is_refused_and_told_to_the_log(port, strangers):
    with ExitStack() as stack, capture_logs() as log:
        known = [stack.enter_context(_associated(port)) for _ in range(_MOST)]
        assert _is_hung_up(strangers(1)[0])
        assert [one.send_c_echo().Status for one in known] == [0] * _MOST
    assert {"dicom_connection_refused"} == {entry["event"] for entry in log}
    assert log[0]["problem"] == "too many associations"


def test_a_connection_that_select_does_not_know_is_refused_and_told_to_the_log(port, strangers, monkeypatch):
    monkeypatch.setattr(dicom_port, "_FIRST_NOT_SELECTABLE", 3)
    with capture_logs() as log:
        assert _is_hung_up(strangers(1)[0])
    assert log[0]["problem"] == "too many open files"


def test_no_room_is_made_for_a_unit_that_nobody_may_send(port, strangers):
    (peer,) = strangers(1, struct.pack(">BBL", 1, 0, 2**31))
    sent, give_up_s = 0, time.monotonic() + 60.0
    with pytest.raises(OSError):  # noqa: PT012  as soon as the port has closed
        while time.monotonic() < give_up_s:
            sent += peer.send(bytes(65_536))
    assert sent < 64 * dicom_port.PDU_BYTES
