"""The receiver against dcmtk's storescu and against peers that send what no honest program would."""

import hashlib
import socket
import subprocess
import threading
import time
from contextlib import ExitStack
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import pynetdicom
import pytest
import sqlalchemy as sa
from pydicom import dcmread
from pynetdicom import AE
from pynetdicom.sop_class import XRayAngiographicImageStorage
from structlog.testing import capture_logs

from service.database.engines import Database
from service.database.tables import audit_events
from service.errors import ErrorCode
from service.images import store
from service.images.arrivals import ImageArrivals
from service.images.receiver import DicomReceiver
from service.settings import DicomSettings
from tests.waiting import until

_MAX_BYTES = 300_000


@dataclass
class Receiving:
    """A receiver at work, and dcmtk to send to it."""

    port: int
    database: Database
    arrived: list[str]
    program: str
    folder: Path

    def send(self, *contents: bytes, calling: str = "CARM") -> subprocess.CompletedProcess:
        files = []
        for index, content in enumerate(contents):
            files.append(self.folder / f"{hashlib.sha256(content).hexdigest()[:16]}-{index}.dcm")
            files[-1].write_bytes(content)
        command = [self.program, "-v", "-aet", calling, "127.0.0.1", str(self.port), *map(str, files)]
        return subprocess.run(command, capture_output=True, text=True, timeout=60)

    def images(self) -> list[store.StoredImage]:
        with self.database.read() as connection:
            return store.list_images(connection)[::-1]


@pytest.fixture
def log():
    with capture_logs() as entries:
        yield entries


@pytest.fixture
def receive(database, storescu, tmp_path):
    with ExitStack() as stack:

        def start(check_room=lambda: None, **settings) -> Receiving:
            arrivals, arrived = ImageArrivals(), []
            arrivals.listen(arrived.append)
            limits = DicomSettings(port=0, max_image_bytes=_MAX_BYTES, **{"accepted_callers": ("CARM",)} | settings)
            port = stack.enter_context(DicomReceiver(limits, database, arrivals, check_room).listening())
            return Receiving(port, database, arrived, storescu, tmp_path)

        yield start


def _send_to_the_byte(port: int, file: Path, monkeypatch: pytest.MonkeyPatch) -> object:
    """Send a file's data set as it stands, where storescu would notice that it is broken."""
    monkeypatch.setattr(pynetdicom._config, "STORE_SEND_CHUNKED_DATASET", True)
    entity = AE("CARM")
    entity.add_requested_context(XRayAngiographicImageStorage, "1.2.840.10008.1.2.1")
    association = entity.associate("127.0.0.1", port)
    status = association.send_c_store(file)
    association.release()
    return status


def test_success_means_that_the_bytes_are_stored(receive, make_xray):
    room = receive()
    content = make_xray()
    assert "Received Store Response (Success)" in room.send(content).stderr
    (image,) = room.images()
    assert room.arrived == [image.id]
    assert (image.patient_id, image.study_uid, image.problem, image.duplicate_of) == ("P1", "1.2.3", None, None)
    assert (image.metadata["rows"], image.metadata["columns"], image.metadata["bits"]) == (96, 80, 12)
    assert image.metadata["positioner_primary_deg"] == 10.5
    assert "Doe" not in str(image)
    with room.database.read() as connection:
        original = store.original_bytes(connection, image.id)
    sent, kept = dcmread(BytesIO(content)), dcmread(BytesIO(original))
    assert kept.to_json() == sent.to_json(), "the data set that was sent, whole"
    assert kept.PixelData == sent.PixelData


@pytest.mark.hazard("H02")
def test_an_image_that_is_sent_again_is_answered_with_success_and_is_the_image_that_it_was(receive, make_xray):
    room = receive()
    content = make_xray()
    assert room.send(content).returncode == room.send(content, content).returncode == 0
    (image,) = room.images()
    assert (image.duplicate_of, room.arrived) == (None, [image.id])
    assert (
        _audited(room, "image_sent_again") == [{"image_id": image.id, "calling_ae": "CARM", "address": "127.0.0.1"}] * 2
    )


@pytest.mark.hazard("H02")
def test_other_bytes_under_the_same_uid_are_refused_and_nothing_of_them_is_stored(receive, make_xray):
    room = receive()
    room.send(make_xray(seed=1, SOPInstanceUID="1.2.3.4"))
    for other in (make_xray(seed=2, SOPInstanceUID="1.2.3.4"), make_xray(seed=1, SOPInstanceUID="1.2.3.4", KVP=80)):
        assert "CannotUnderstand" in room.send(other).stderr
    (image,) = room.images()
    assert room.arrived == [image.id]
    assert [refused["code"] for refused in _audited(room, "image_refused")] == [ErrorCode.IMAGE_UID_TAKEN] * 2


def test_an_image_that_came_cut_short_leaves_its_uid_to_the_whole_one(receive, make_xray):
    room = receive()
    cut, whole = (make_xray(SOPInstanceUID="1.2.3.4", **more) for more in ({"Rows": 200}, {}))
    assert "CannotUnderstand" in room.send(cut).stderr
    assert "CannotUnderstand" in room.send(cut).stderr, "the same answer as before"
    assert room.send(whole).returncode == 0
    assert "CannotUnderstand" in room.send(cut).stderr
    first, second = room.images()
    assert (first.problem["code"], second.problem, second.duplicate_of) == (ErrorCode.IMAGE_TRUNCATED, None, None)


def _audited(room: Receiving, kind: str) -> list[dict]:
    with room.database.read() as connection:
        rows = connection.execute(sa.select(audit_events).where(audit_events.c.kind == kind))
        return [row.data for row in rows]


def test_the_same_pixels_under_a_new_identity_are_a_duplicate(receive, make_xray):
    room = receive()
    room.send(make_xray(seed=1))
    room.send(make_xray(seed=1))
    room.send(make_xray(seed=2))
    first, again, other = room.images()
    assert first.sop_uid != again.sop_uid
    assert again.duplicate_of == first.id
    assert other.duplicate_of is None


@pytest.mark.hazard("H31")
@pytest.mark.parametrize(
    ("elements", "code"),
    [
        ({"rows": 1, "columns": 1}, ErrorCode.IMAGE_TOO_SMALL),
        ({"PixelData": None}, ErrorCode.NOT_AN_IMAGE),
        ({"Rows": 200}, ErrorCode.IMAGE_TRUNCATED),
        ({"Rows": 10_000, "Columns": 10_000}, ErrorCode.IMAGE_BYTES_TOO_LARGE),
        ({"NumberOfFrames": 3}, ErrorCode.SEVERAL_FRAMES),
        ({"PatientID": "P\x001"}, ErrorCode.NOT_AN_IMAGE),
    ],
)
def test_what_is_no_usable_image_is_kept_and_answered_with_failure_and_its_code(receive, make_xray, elements, code):
    room = receive()
    sent = room.send(make_xray(**elements))
    assert "CannotUnderstand" in sent.stderr
    (image,) = room.images()
    assert image.problem["code"] == code
    assert room.send(make_xray()).returncode == 0, "the receiver goes on"


def test_a_data_set_cut_in_the_middle_is_kept_and_refused(receive, make_xray, tmp_path, monkeypatch):
    room = receive()
    file = tmp_path / "cut.dcm"
    file.write_bytes(make_xray()[:-5000])
    status = _send_to_the_byte(room.port, file, monkeypatch)
    assert status.Status == 0xC000
    assert status.ErrorComment in (ErrorCode.IMAGE_TRUNCATED, ErrorCode.NOT_AN_IMAGE)
    (image,) = room.images()
    assert image.problem["code"] == status.ErrorComment


@pytest.mark.hazard("H31")
def test_an_image_over_the_byte_limit_is_cut_off_before_it_is_whole(receive, make_xray):
    room = receive()
    sent = room.send(make_xray(rows=1000, columns=1000))  # 2 MB against 0.3 MB
    assert sent.returncode != 0
    assert room.images() == []
    assert room.send(make_xray()).returncode == 0


def test_several_images_on_one_association_do_not_add_up_to_the_byte_limit(receive, make_xray):
    room = receive()
    sent = room.send(*(make_xray(rows=300, columns=300, seed=seed) for seed in range(4)))  # 4 x 0.18 MB
    assert sent.returncode == 0
    assert len(room.images()) == 4


def test_a_caller_that_is_not_named_is_refused_and_told_to_the_log_by_title(receive, make_xray, log):
    room = receive(accepted_callers=("CARM", "CARM2"))
    for stranger in ("STRANGER", "carm", "CARM3", "CAR"):
        refused = room.send(make_xray(), calling=stranger)
        assert "Calling AE Title Not Recognized" in refused.stderr
        assert log[-1]["event"] == "dicom_caller_refused"
        assert log[-1]["calling_ae"] == stranger
    assert room.images() == []
    assert room.send(make_xray(), calling="CARM2").returncode == 0


def test_where_no_caller_is_named_nobody_comes_in_and_the_log_says_what_to_set(receive, make_xray, log):
    room = receive(accepted_callers=())
    assert [entry["event"] for entry in log] == ["dicom_accepts_nobody"]
    assert "accepted_callers" in log[0]["what_to_do"]
    for caller in ("CARM", "ANY-SCP"):
        assert "Calling AE Title Not Recognized" in room.send(make_xray(), calling=caller).stderr
    assert room.images() == []


def test_a_sender_that_breaks_off_is_told_of_in_the_log(receive, log):
    room = receive()
    entity = AE("CARM")
    entity.add_requested_context(XRayAngiographicImageStorage, "1.2.840.10008.1.2.1")
    for break_off in (lambda association: association.abort(), lambda association: association.dul.socket.close()):
        log.clear()
        break_off(entity.associate("127.0.0.1", room.port))
        until(lambda: [entry["event"] for entry in log] == ["dicom_broken_off"])
        assert log[0]["calling_ae"] == "CARM"


@pytest.mark.hazard("H31")
def test_noise_on_the_port_is_borne(receive, make_xray):
    room = receive()
    for noise in (b"GET / HTTP/1.1\r\n\r\n", b"\x01\x00\xff\xff\xff\xff", bytes(4096)):
        with socket.create_connection(("127.0.0.1", room.port)) as peer:
            peer.sendall(noise)
    assert room.send(make_xray()).returncode == 0


def test_images_sent_at_once_are_all_stored(receive, make_xray):
    room = receive()
    contents = [make_xray(seed=seed) for seed in range(8)]
    results = []
    threads = [threading.Thread(target=lambda one=one: results.append(room.send(one).returncode)) for one in contents]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [0] * 8
    assert sorted(image.position for image in room.images()) == list(range(1, 9))


def test_a_failing_listener_does_not_make_a_stored_image_fail(database, storescu, tmp_path, make_xray):
    arrivals, arrived = ImageArrivals(), []

    def fail(_image_id: str) -> None:
        raise RuntimeError("listener")

    arrivals.listen(fail)
    arrivals.listen(arrived.append)
    with DicomReceiver(
        DicomSettings(port=0, accepted_callers=("CARM",)), database, arrivals, lambda: None
    ).listening() as port:
        room = Receiving(port, database, arrived, storescu, tmp_path)
        assert room.send(make_xray()).returncode == 0
    assert len(arrived) == 1


@pytest.mark.hazard("H24")
@pytest.mark.sqlite
def test_bytes_that_cannot_be_committed_are_answered_with_failure(receive, make_xray):
    room = receive()
    with room.database.writer.connect() as connection:
        pages = connection.exec_driver_sql("PRAGMA page_count").scalar()
        connection.exec_driver_sql(f"PRAGMA max_page_count={pages}")
    sent = room.send(make_xray())
    assert "OutOfResources" in sent.stderr
    assert room.images() == []
    assert room.arrived == []


def test_the_answer_comes_after_the_commit(receive, make_xray):
    """While another transaction holds the writer, no success can be told."""
    room = receive()
    answered = []
    sender = threading.Thread(target=lambda: answered.append(room.send(make_xray()).returncode))
    with room.database.write():
        sender.start()
        time.sleep(1.0)
        assert answered == []
    sender.join()
    assert answered == [0]
