"""`coaxial doctor`: what is well passes, what is not says what to do, and looking changes nothing."""

import json
import socket
import time
from collections.abc import Callable
from datetime import datetime, timedelta
from http.server import HTTPServer, SimpleHTTPRequestHandler
from pathlib import Path
from threading import Thread
from urllib.parse import urlsplit

import pytest
from pynetdicom import AE
from pynetdicom.sop_class import Verification
from typer.testing import CliRunner

from service.auth.permissions import Role
from service.cli.doctor import doctor
from service.devices.store import DeviceKind, add_device
from service.images.arrivals import ImageArrivals
from service.images.receiver import DicomReceiver
from service.ledger.keys import signing_key
from service.operations.doctor import examine
from service.settings import AuditSettings, DicomSettings, HttpSettings, PeerSettings, Settings


class HTTPServer6(HTTPServer):
    """A web server on an IPv6 address."""

    address_family = socket.AF_INET6


@pytest.fixture
def well(tmp_path, database, users, device_files) -> Settings:
    """The settings of a room in which all is well."""
    surgeon = users.add("anna", Role.SURGEON, "correct horse", "2468")
    with database.write() as connection:
        for kind, content in device_files.items():
            add_device(connection, DeviceKind(kind), content.encode(), surgeon.id)
    signing_key(tmp_path / "audit" / "signing.key")
    return Settings(
        data_folder=tmp_path,
        database_url=database.writer.url.render_as_string(hide_password=False),
        min_free_bytes=0,
        dicom=DicomSettings(port=0, accepted_callers=("CARM",)),
    )


def _changed(settings: Settings, **changes: object) -> Settings:
    return settings.model_copy(update=changes)


def _failed(settings: Settings) -> dict[str, str]:
    """What failed, with what to do; without what is this machine's, and the tests' server's, own."""
    own = {"clock_synchronised"} | ({"database_durable"} if settings.database_url.startswith("postgresql") else set())
    return {one.code: one.what_to_do for one in examine(settings) if not one.passed and one.code not in own}


def test_where_all_is_well_every_item_passes(well):
    assert _failed(well) == {}
    codes = {one.code for one in examine(well)}
    assert {"disk_free", "signing_key", "database_durable", "surgeons", "guide_in_date", "dicom_port"} <= codes


@pytest.mark.parametrize(
    ("spoil", "code"),
    [
        (lambda s: _changed(s, min_free_bytes=10**18), "disk_free"),
        (lambda s: _changed(s, arm_address="127.0.0.9"), "arm_dashboard"),
        (lambda s: _changed(s, http=HttpSettings(host="203.0.113.1")), "http_port"),
        (lambda s: _changed(s, data_folder=s.key_file), "data_folder"),
        (
            lambda s: _changed(s, audit=AuditSettings(anchor_file=s.data_folder / "away" / "head.json")),
            "anchor_elsewhere",
        ),
        (lambda s: _changed(s, dicom=DicomSettings(port=0)), "dicom_callers"),
        (lambda s: _changed(s, dicom=DicomSettings(host="203.0.113.1", accepted_callers=("CARM",))), "dicom_port"),
        (lambda s: _changed(s, pacs=PeerSettings(host="127.0.0.9", port=1)), "archive"),
        (lambda s: _changed(s, worklist=PeerSettings(host="127.0.0.9", port=1)), "worklist"),
        (lambda s: s.key_file.chmod(0o644) or s, "key_refused"),
        (lambda s: s.key_file.unlink() or s, "signing_key"),
    ],
)
def test_what_is_wrong_is_named_and_says_what_to_do(well, spoil: Callable[[Settings], Settings], code):
    failed = _failed(spoil(well))
    assert code in failed
    assert failed[code].endswith(".")


def test_a_variable_that_sets_nothing_is_named_and_its_value_is_not(well, monkeypatch):
    for name in ("COAXIAL_MIN_FREE_BYTES", "COAXIAL_HTTP__PORT", "COAXIAL_PIN", "COAXIALLY"):
        monkeypatch.setenv(name, "1")
    assert _failed(well) == {}
    monkeypatch.setenv("COAXIAL_DATABASE_URI", "postgresql://coaxial:secret@db/coaxial")
    assert _failed(well).keys() == {"environment"}
    assert "secret" not in str(examine(well))


def test_an_anchor_on_another_disk_passes(well):
    assert _failed(_changed(well, audit=AuditSettings(anchor_file=Path("/proc/away/head.json")))) == {}


def test_a_folder_that_takes_no_file_and_a_key_out_of_reach_say_whose_they_should_be(well, monkeypatch):
    def closed(file: Path) -> None:
        raise PermissionError(13, "Permission denied", str(file))

    monkeypatch.setattr("service.operations.doctor.os.access", lambda path, _: path != well.data_folder)
    monkeypatch.setattr("service.operations.doctor.kept_key", closed)
    failed = _failed(well)
    assert failed.keys() == {"data_folder_writable", "file_access"}
    assert all("service's user" in cure for cure in failed.values())


def test_a_device_file_past_its_date_is_named(well, database, users, device_files):
    old = device_files["tcp"].replace('version = "1"', 'version = "0"\nexpires = 2020-01-31')
    with database.write() as connection:
        add_device(connection, DeviceKind.TCP, old.encode(), users.list()[0].id)
    assert "upload a new tcp file" in _failed(well)["tcp_in_date"]


def test_a_clock_behind_the_newest_record_is_found(well, monkeypatch):
    class Yesterday(datetime):
        @classmethod
        def now(cls, tz=None):
            return datetime.now(tz) - timedelta(days=1)

    monkeypatch.setattr("service.operations.doctor.datetime", Yesterday)
    assert "clock_after_record" in _failed(well)


def test_a_server_that_would_lose_commits_in_a_power_cut_is_named(well):
    """As that of these tests would; SQLite is refused at its opening where it does not keep its journal."""
    [mode] = [one for one in examine(well) if one.code == "database_durable"]
    told = (False, "fsync") if well.database_url.startswith("postgresql") else (True, "WAL, synchronous FULL")
    assert (mode.passed, mode.measured) == told


def test_looking_at_nothing_makes_nothing(tmp_path):
    folder = tmp_path / "none"
    failed = _failed(Settings(data_folder=folder, dicom=DicomSettings(port=0, accepted_callers=("CARM",))))
    assert failed.keys() == {"data_folder", "signing_key", "database"}
    assert not folder.exists()


def test_a_room_without_users_or_device_files_says_so(tmp_path, database):
    settings = Settings(data_folder=tmp_path, database_url=database.writer.url.render_as_string(hide_password=False))
    assert {"surgeons", "device_unknown"} <= _failed(settings).keys()


def test_every_device_file_that_is_missing_is_named_at_once(tmp_path, database, users, device_files):
    settings = Settings(data_folder=tmp_path, database_url=database.writer.url.render_as_string(hide_password=False))
    surgeon = users.add("anna", Role.SURGEON, "correct horse", "2468")
    with database.write() as connection:
        add_device(connection, DeviceKind.CARM, device_files["carm"].encode(), surgeon.id)
    [missing] = [one for one in examine(settings) if one.code == "device_unknown"]
    assert missing.measured == "nothing of guide, tcp, room was uploaded"


def test_a_dicom_port_that_another_program_has_is_told_from_the_service_s_own(well, database):
    own = DicomReceiver(well.dicom, database, ImageArrivals(), lambda: None)
    with own.listening() as port:
        assert _failed(_changed(well, dicom=well.dicom.model_copy(update={"port": port}))) == {}
    with HTTPServer(("127.0.0.1", 0), SimpleHTTPRequestHandler) as other:
        Thread(target=other.serve_forever, daemon=True).start()
        failed = _failed(_changed(well, dicom=well.dicom.model_copy(update={"port": other.server_port})))
        other.shutdown()
    assert set(failed) == {"dicom_service"}
    assert "Another program has the port" in failed["dicom_service"]


def test_another_dicom_program_that_answers_an_echo_is_not_taken_for_the_service(well):
    archive = AE(ae_title="COAXIAL")
    archive.implementation_class_uid = "1.2.276.0.7230010.3.0.3.6.7"  # dcmtk's
    archive.add_supported_context(Verification)
    other = archive.start_server(("127.0.0.1", 0), block=False)
    failed = _failed(_changed(well, dicom=well.dicom.model_copy(update={"port": other.socket.getsockname()[1]})))
    other.shutdown()
    assert set(failed) == {"dicom_service"}


def test_a_program_at_the_dicom_port_that_says_nothing_is_not_waited_for_long(well):
    with socket.create_server(("127.0.0.1", 0)) as silent:
        settings = _changed(well, dicom=well.dicom.model_copy(update={"port": silent.getsockname()[1]}))
        begun_s = time.monotonic()
        assert set(_failed(settings)) == {"dicom_service"}
    assert time.monotonic() - begun_s < 12.0  # s; 5 are given to the answer, 15 or more were


def test_an_ipv6_address_of_this_machine_is_one(well, database):
    dicom_settings = well.dicom.model_copy(update={"host": "::1"})
    with HTTPServer6(("::1", 0), SimpleHTTPRequestHandler) as other:
        Thread(target=other.serve_forever, daemon=True).start()
        settings = _changed(well, http=HttpSettings(host="::1", port=other.server_port))
        items = {one.code: one for one in examine(settings)}
        other.shutdown()
    assert items["http_port"].passed
    assert items["http_port"].measured == f"[::1]:{other.server_port}"
    assert "Another program" in items["http_service"].what_to_do
    with DicomReceiver(dicom_settings, database, ImageArrivals(), lambda: None).listening() as port:
        assert _failed(_changed(well, dicom=dicom_settings.model_copy(update={"port": port}))) == {}


def test_a_port_that_another_program_has_is_told_from_the_service_s_own(well, running):
    with HTTPServer(("127.0.0.1", 0), SimpleHTTPRequestHandler) as other:
        Thread(target=other.serve_forever, daemon=True).start()
        failed = _failed(_changed(well, http=HttpSettings(port=other.server_port)))
        other.shutdown()
    assert set(failed) == {"http_service"}
    assert "Another program has the port" in failed["http_service"]
    own = HttpSettings(port=urlsplit(running.url).port or 0)
    assert _failed(_changed(well, http=own)) == {}


def test_the_command_prints_lines_or_json_and_ends_with_3_where_something_fails(well, monkeypatch):
    monkeypatch.setenv("COAXIAL_DATABASE_URL", well.database_url)
    monkeypatch.setenv("COAXIAL_MIN_FREE_BYTES", str(10**18))
    lines = CliRunner().invoke(doctor, ["--data-folder", str(well.data_folder)])
    assert lines.exit_code == 3
    assert "FAIL  disk_free" in lines.output
    assert "limit None" not in lines.output
    told = json.loads(CliRunner().invoke(doctor, ["--data-folder", str(well.data_folder), "--json"]).output)
    assert told["passed"] is False
    assert {"code", "passed", "measured", "limit", "unit", "what_to_do"} == told["items"][0].keys()


@pytest.mark.parametrize(("version", "cure"), [("0001", "coaxial db upgrade"), ("9999", "version that wrote")])
def test_an_older_schema_is_told_from_a_newer_one(well, database, version, cure):
    with database.writer.begin() as connection:
        connection.exec_driver_sql(f"UPDATE alembic_version SET version_num = '{version}'")
    assert cure in _failed(well)["database_schema"]
