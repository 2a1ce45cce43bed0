"""What a case leaves, sent to a real Orthanc and read back from it."""

import json
import subprocess
from contextlib import closing, contextmanager
from io import BytesIO
from types import SimpleNamespace

import httpx
import pytest
from pydicom import Dataset, dcmread
from pynetdicom import AE, evt
from structlog.testing import capture_logs

from service.archive.contents import IMPORTED
from service.audit import record_audit
from service.auth.permissions import Role
from service.cases import store
from service.cases.records import NewCase, NewEvent
from service.cases.verifications import verifications_of
from service.database.engines import open_database
from service.ledger.draft import describe
from service.pacs import outbox
from service.pacs.delivering import send_waiting
from service.settings import DicomSettings, HttpSettings, PeerSettings, Settings
from tests.waiting import until

_CASE = "case-1"
_PATIENCE_S = 150.0


@pytest.fixture
def archive(tmp_path, program_at_work):
    """An Orthanc on two ports; the folder outlives it."""

    @contextmanager
    def start(dicom_port: int, http_port: int):
        settings = {
            "DicomPort": dicom_port,
            "DicomAet": "PACS",
            "HttpPort": http_port,
            "RemoteAccessAllowed": False,
            "AuthenticationEnabled": False,
            "StorageDirectory": str(tmp_path / "orthanc"),
            "Plugins": [],
            "DicomCheckCalledAet": True,
        }
        (tmp_path / "orthanc.json").write_text(json.dumps(settings))
        running = program_at_work(dicom_port, "Orthanc", str(tmp_path / "orthanc.json"))
        with running, httpx.Client(base_url=f"http://127.0.0.1:{http_port}", timeout=20) as client:
            yield client

    return start


@pytest.fixture
def left_behind(tmp_path, databases, users_of, add_case_that_is_over):
    """The address of the record of a case that is over, and of an older one of which nothing can be made."""
    with databases.migrated(tmp_path) as address:
        with closing(open_database(address)) as database:
            surgeon = users_of(database)
            _add_case_without_devices(database, surgeon)
            add_case_that_is_over(database, surgeon)
        yield address


def _add_case_without_devices(database, user_id: str) -> None:
    case = NewCase("case-0", "room-1", "P0", "1.2.4", user_id, "0" * 64, {}, {})
    with database.write() as connection:
        store.open_case(connection, case, NewEvent("case_opened", user_id, "case_open", {}, {}))
        store.append(connection, "case-0", NewEvent("case_closed", user_id, "closed", {}, {}), expected_version=None)


def _settings(folder, address: str, port: int) -> Settings:
    return Settings(
        data_folder=folder,
        database_url=address,
        min_free_bytes=0,
        http=HttpSettings(port=0),
        dicom=DicomSettings(port=0),
        pacs=PeerSettings(host="127.0.0.1", port=port),
    )


def _sent(service) -> list[dict]:
    with service.client(Role.AUDITOR) as client:
        return client.get(f"/cases/{_CASE}/sent").json()


@pytest.mark.timeout(360)
def test_what_an_archive_that_was_down_missed_reaches_it_after_a_restart(
    left_behind, serving, archive, free_ports, tmp_path
):
    dicom_port, http_port = free_ports(2)
    with serving(_settings(tmp_path, left_behind, dicom_port)) as service:
        until(lambda: len(_sent(service)) == 4, _PATIENCE_S)
        assert not any(one["delivered"] for one in _sent(service))
    with archive(dicom_port, http_port) as peer, serving(_settings(tmp_path, left_behind, dicom_port)) as service:
        until(lambda: all(one["delivered"] for one in _sent(service)), _PATIENCE_S)
        assert {one["answer"] for one in _sent(service)} == {"status 0x0000"}
        send_waiting(service.parts)
        with service.client(Role.OPERATOR) as client:
            shown = client.get(f"/cases/{_CASE}/report")
        instances = [peer.get(f"/instances/{one}/file").content for one in peer.get("/instances").json()]
    kept = {str(dataset.SOPInstanceUID): dataset for dataset in (dcmread(BytesIO(one)) for one in instances)}
    with (
        closing(open_database(left_behind)) as database,
        database.read() as connection,
    ):
        assert kept.keys() == {one.id for one in outbox.objects_of(connection, _CASE)}
        (verified,) = verifications_of(connection, _CASE)
    assert shown.headers["content-type"] == "application/pdf"
    _is_whole(kept, verified.figures, shown.content, tmp_path)


def _is_whole(kept, recorded, shown, folder) -> None:
    pictures = [one for one in kept.values() if one.Modality == "XA"]
    (report,) = (one for one in kept.values() if one.Modality == "SR")
    (document,) = (one for one in kept.values() if one.Modality == "DOC")
    assert {one.PatientID for one in kept.values()} == {"P1"}
    assert {str(one.PatientName) for one in kept.values()} == {"Doe^Jane"}
    assert {one.StudyInstanceUID for one in kept.values()} == {"1.2.3"}
    assert len({one.SeriesInstanceUID for one in kept.values()}) == 3
    assert [one.pixel_array.shape[2] for one in pictures] == [3, 3]
    assert sorted(one.ImageComments for one in pictures) == ["registration", "verification, L3 left"]
    assert document.EncapsulatedDocument[: document.EncapsulatedDocumentLength] == shown
    assert shown.startswith(b"%PDF-1.7")
    figures = _numbers(report)
    assert figures["Target depth below the big ring"] == 80.0
    assert figures["Position error by contours"] == pytest.approx(recorded["contour"]["position_error_mm"])
    assert figures["Angle error by ring centres"] == pytest.approx(recorded["paper"]["angle_error_deg"])
    assert figures["Guide origin z from source"] == pytest.approx(750.0, abs=10.0), "depth and focal length trade"
    assert figures["Guide rotation vector x from source"] == pytest.approx(8.0, abs=0.5)
    for uid, dataset in kept.items():
        dataset.save_as(folder / f"{uid}.dcm")
        checked = subprocess.run(
            ["dciodvfy", folder / f"{uid}.dcm"], capture_output=True, text=True, timeout=60, check=False
        )
        assert "Error" not in checked.stdout + checked.stderr, checked.stderr


def _numbers(item) -> dict[str, float]:
    found = {}
    for child in item.get("ContentSequence", ()):
        if child.ValueType == "NUM":
            name = child.ConceptNameCodeSequence[0].CodeMeaning
            found[name] = float(child.MeasuredValueSequence[0].NumericValue)
        found |= _numbers(child)
    return found


def test_what_is_made_again_is_the_same_object_and_what_repeats_is_no_news(database, surgeon, add_case_that_is_over):
    add_case_that_is_over(database, surgeon)
    made = outbox.DerivedObject("annotated_image", "1.2", "2.25.1", b"file")
    with database.write() as connection:
        outbox.queue(connection, _CASE, [made])
    with database.read() as connection:
        assert outbox.cases_to_prepare(connection, "room-1") == []
        (waiting,) = outbox.undelivered(connection)
    for answer in ("no answer", "no answer", "status 0x0000"):
        with database.write() as connection:
            (waiting,) = outbox.undelivered(connection)
            outbox.record_delivery(connection, waiting, answer, accepted=answer.startswith("status"))
    with database.read() as connection:
        assert outbox.undelivered(connection) == []
        (sent,) = outbox.objects_of(connection, _CASE)
        answers = connection.exec_driver_sql("SELECT answer FROM deliveries ORDER BY id").scalars().all()
    assert (sent.delivered, answers) == (True, ["no answer", "status 0x0000"])


def test_the_words_of_an_archive_are_recorded_and_not_logged(
    database, surgeon, add_case_that_is_over, make_xray, tmp_path
):
    """It may have named the patient in them."""
    add_case_that_is_over(database, surgeon)
    image = make_xray()
    sop_class, uid = dcmread(BytesIO(image)).SOPClassUID, dcmread(BytesIO(image)).SOPInstanceUID
    with database.write() as connection:
        outbox.queue(connection, _CASE, [outbox.DerivedObject("annotated_image", sop_class, uid, image)])
    with _refusing(sop_class, "no room for Doe^Jane") as port, capture_logs() as log:
        send_waiting(SimpleNamespace(settings=_settings(tmp_path, "sqlite:///unused", port), database=database))
    with database.read() as connection:
        assert [one.answer for one in outbox.objects_of(connection, _CASE)] == ["status 0xA700 no room for Doe^Jane"]
        assert outbox.count_undelivered(connection) == 1
    (told,) = (entry for entry in log if entry["event"] == "object_sent")
    assert (told["accepted"], told["status"]) == (False, "status 0xA700")
    assert "Doe" not in str(log)


@contextmanager
def _refusing(sop_class: str, comment: str):
    answer = Dataset()
    answer.Status, answer.ErrorComment = 0xA700, comment
    entity = AE("PACS")
    entity.add_supported_context(sop_class)
    server = entity.start_server(("127.0.0.1", 0), block=False, evt_handlers=[(evt.EVT_C_STORE, lambda _event: answer)])
    yield server.socket.getsockname()[1]
    server.shutdown()


def test_only_the_rooms_own_cases_that_are_over_are_sent(database, surgeon, add_case_that_is_over):
    add_case_that_is_over(database, surgeon)
    with database.read() as connection:
        assert outbox.cases_to_prepare(connection, "room-1") == [_CASE]
        assert outbox.cases_to_prepare(connection, "room-2") == []
    with database.write() as connection:
        record_audit(connection, IMPORTED, surgeon, {})
        describe(connection, action=IMPORTED, case_id=_CASE)
    with database.read() as connection:
        assert outbox.cases_to_prepare(connection, "room-1") == []
