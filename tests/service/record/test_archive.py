"""A case as one file: complete, the same every time, checked without a database, brought back elsewhere."""

import io
import json
import os
import shutil
import sqlite3
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pydicom
import pytest
from typer.testing import CliRunner, Result

from service.archive import exporting, importing
from service.archive.checking import check_file
from service.archive.container import open_archive
from service.auth.permissions import Role
from service.cases import store
from service.cases.attempts import record_attempt
from service.cases.records import NewAttempt, NewVerdict
from service.cli.audit import audit
from service.cli.case import case
from service.database.current import current_database
from service.images.store import count_images
from service.ledger.keys import public_file, signing_key
from service.ledger.verifying import verify
from service.settings import DicomSettings, HttpSettings, Settings
from workflow.states import State

pytestmark = pytest.mark.usefixtures("remembered_jobs")


def _run(*arguments: object) -> Result:
    return CliRunner().invoke(case, [str(one) for one in arguments])


def _export(folder: Path, case_id: str, out: Path, *options: str) -> Path:
    result = _run("export", case_id, "--out", out, "--data-folder", folder, *options)
    assert result.exit_code == 0, result.output
    return out


@pytest.fixture(scope="session")
def kept_archive(kept_site, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("exported")
    shutil.copytree(kept_site.folder, folder / "site")
    return _export(folder / "site", kept_site.case_id, folder / "case.zip")


@pytest.fixture
def rewritten(kept_archive, tmp_path) -> Callable[[Callable[[dict[str, bytes]], object]], Path]:
    """The archive with some members changed, as somebody does who has the file."""

    def write(change: Callable[[dict[str, bytes]], object]) -> Path:
        with zipfile.ZipFile(kept_archive) as file:
            members = {name: file.read(name) for name in file.namelist()}
        change(members)
        out = tmp_path / "changed.zip"
        with zipfile.ZipFile(out, "w") as file:
            for name, content in members.items():
                file.writestr(name, content)
        return out

    return write


def _member(members: dict[str, bytes], start: str) -> str:
    return next(name for name in sorted(members) if name.startswith(start))


def test_an_archive_verifies_without_a_database_and_says_by_whose_key(kept_archive, kept_site) -> None:
    result = _run("verify", kept_archive)
    assert result.exit_code == 0, result.output
    assert "nothing found" in result.stdout
    assert kept_site.case_id in result.stdout
    key = public_file(kept_site.settings.key_file)
    assert _run("verify", kept_archive, "--public-key", key).exit_code == 0


def test_another_key_is_not_believed(kept_archive, tmp_path) -> None:
    signing_key(tmp_path / "other.key")
    result = _run("verify", kept_archive, "--public-key", tmp_path / "other.pub")
    assert result.exit_code == 1
    assert "manifest.json: signed by an unknown key" in result.stdout


def test_the_same_case_gives_the_same_file(site, tmp_path) -> None:
    first = _export(site.folder, site.case_id, tmp_path / "first.zip")
    again = _export(site.folder, site.case_id, tmp_path / "again.zip")
    assert first.read_bytes() == again.read_bytes()


def test_the_archive_holds_the_images_as_they_arrived(kept_archive, results) -> None:
    with zipfile.ZipFile(kept_archive) as file:
        images = [file.read(name) for name in file.namelist() if name.endswith(".dcm")]
    assert sorted(images) == sorted(results.images)


def _set(name: str, content: bytes) -> Callable[[dict[str, bytes]], object]:
    return lambda members: members.update({_member(members, name): content})


def _flip(name: str, place: int) -> Callable[[dict[str, bytes]], object]:
    def change(members: dict[str, bytes]) -> None:
        member = _member(members, name)
        content = bytearray(members[member])
        content[place] ^= 1
        members[member] = bytes(content)

    return change


@pytest.mark.parametrize(
    ("change", "where"),
    [
        (_flip("files/", 100), "files/"),
        (_flip("rows/registrations", 700), "rows/registrations.jsonl"),
        (_flip("ledger/entries", 300), "ledger/entries.jsonl"),
        (_flip("manifest.json", 20), "manifest.json"),
        (_flip("manifest.sig", 3), "manifest.json"),
        (lambda members: members.pop(_member(members, "rows/events")), "rows/events.jsonl"),
        (lambda members: members.update({"rows/more.jsonl": b"{}\n"}), "rows/more.jsonl"),
        (_set("public-key", b"none"), "public-key.pem"),
    ],
)
def test_whatever_is_changed_in_the_file_is_found_and_named(rewritten, change, where) -> None:
    wheres = [finding.where for finding in check_file(rewritten(change), {}).findings]
    assert any(one.startswith(where) for one in wheres), wheres


def _signed_anew(change: Callable[[dict[str, list[Any]]], object], site) -> Callable[[dict[str, bytes]], None]:
    """Changed, and the manifest made and signed anew: as whoever has the workstation's key could."""

    def rewrite(members: dict[str, bytes]) -> None:
        lines = {
            name: [json.loads(text) for text in content.splitlines()]
            for name, content in members.items()
            if name.endswith(".jsonl")
        }
        change(lines)
        for name, some in lines.items():
            members[name] = b"".join(json.dumps(one).encode() + b"\n" for one in some)
        signer = signing_key(site.settings.key_file)
        about = {k: v for k, v in json.loads(members["manifest.json"]).items() if k not in ("key", "members")}
        plain = {
            name: one
            for name, one in members.items()
            if name not in ("manifest.json", "manifest.sig", "public-key.pem")
        }
        members["manifest.json"] = exporting.manifest_of(plain, about, signer)
        members["manifest.sig"] = signer.sign(members["manifest.json"].decode()).encode()

    return rewrite


def _drop(name: str, place: int) -> Callable[[dict[str, list[Any]]], object]:
    return lambda lines: lines[name].pop(place)


def _alter(name: str, column: str, value: Any) -> Callable[[dict[str, list[Any]]], object]:
    return lambda lines: lines[name][0].update({column: value})


@pytest.mark.parametrize(
    ("change", "finding"),
    [
        (_alter("rows/targets.jsonl", "recorded_at", "2020"), "not what entry"),
        (_drop("rows/targets.jsonl", 0), "missing: entry"),
        (_drop("rows/events.jsonl", 2), "not one after another"),
        (_drop("ledger/entries.jsonl", -1), "the end was cut off"),
        (_drop("ledger/entries.jsonl", 0), "no entry vouches for it"),
        (_drop("ledger/checkpoints.jsonl", -1), "the end was cut off"),
        (_alter("ledger/checkpoints.jsonl", "signature", "00"), "checkpoint"),
        (_alter("ledger/entries.jsonl", "sha256", "0" * 64), "its text has not its hash"),
    ],
)
def test_even_with_a_manifest_signed_anew_the_ledger_tells(rewritten, kept_site, change, finding) -> None:
    findings = check_file(rewritten(_signed_anew(change, kept_site)), {}).findings
    assert any(finding in f"{one.where} {one.what}" for one in findings), findings


@pytest.mark.parametrize("content", [b"", b"no zip", b"PK\x03\x04" + bytes(100)])
def test_what_is_no_archive_is_refused_in_one_line(tmp_path, content) -> None:
    path = tmp_path / "none.zip"
    path.write_bytes(content)
    result = _run("verify", path)
    assert result.exit_code == 3
    assert "archive_refused" in result.stderr


def _counts(folder: Path) -> dict[str, int]:
    with sqlite3.connect(folder / "coaxial.sqlite") as connection:
        names = [row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        counts = {name: connection.execute(f"SELECT count(*) FROM {name}").fetchone()[0] for name in names}
    connection.close()
    return counts


@pytest.fixture
def elsewhere(make_site, tmp_path) -> Settings:
    """Another workstation with a closed case of its own, of the same devices."""
    return make_site(tmp_path / "elsewhere", State.CLOSED).settings


def test_a_case_comes_back_elsewhere_with_its_ids_and_replays_equal(kept_archive, kept_site, elsewhere) -> None:
    folder = elsewhere.data_folder
    result = _run("import", kept_archive, "--data-folder", folder)
    assert result.exit_code == 0, result.output
    replayed = CliRunner().invoke(audit, ["replay", kept_site.case_id, "--data-folder", str(folder)])
    assert replayed.exit_code == 0, replayed.output
    with current_database(elsewhere) as database:
        signer = signing_key(elsewhere.key_file)
        found = verify(database, {signer.verifier.name: signer.verifier}, elsewhere.anchor_file)
        assert found.findings == []
        with database.read() as connection:
            assert count_images(connection) == 2  # that arrived here; the imported ones did not
    again = _export(folder, kept_site.case_id, folder / "again.zip")
    assert check_file(again, {}).findings == []


def test_importing_twice_changes_nothing(kept_archive, elsewhere) -> None:
    folder = elsewhere.data_folder
    assert "is here" in _run("import", kept_archive, "--data-folder", folder).stdout
    before = _counts(folder)
    assert "the same" in _run("import", kept_archive, "--data-folder", folder).stdout
    assert _counts(folder) == before


def test_a_case_that_is_there_with_other_content_is_refused(kept_archive, site) -> None:
    site.alter("targets", lambda target: target.update(depth_mm=70.0))
    before = _counts(site.folder)
    result = _run("import", kept_archive, "--data-folder", site.folder)
    assert result.exit_code == 3
    assert "case_differs" in result.stderr
    assert _counts(site.folder) == before


def test_an_archive_takes_no_pipe_s_place(kept_archive, kept_site, tmp_path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    result = _run("export", kept_site.case_id, "--out", pipe, "--data-folder", kept_archive.parent / "site")
    assert (result.exit_code, result.stderr) == (2, f"error: {pipe}: a device or a pipe, and no file\n")
    assert pipe.is_fifo()


def test_a_file_that_is_no_archive_begins_no_record(kept_archive, tmp_path) -> None:
    folder = tmp_path / "new"
    for arguments in ((tmp_path / "none",), (kept_archive, "--public-key", tmp_path / "none")):
        result = _run("import", *arguments, "--data-folder", folder)
        assert result.exit_code == 3
        assert not folder.exists()


def test_an_unsound_archive_is_not_imported(rewritten, elsewhere) -> None:
    before = _counts(elsewhere.data_folder)
    result = _run("import", rewritten(_flip("files/", 100)), "--data-folder", elsewhere.data_folder)
    assert (result.exit_code, _counts(elsewhere.data_folder)) == (3, before)
    assert "archive_refused" in result.stderr


def test_a_case_that_was_under_way_is_held_where_it_is_brought_to(make_site, elsewhere, tmp_path) -> None:
    live = make_site(tmp_path / "live", State.REGISTERED)
    archive = _export(live.folder, live.case_id, tmp_path / "live.zip")
    assert _run("verify", archive).exit_code == 0
    with current_database(elsewhere) as database:
        assert importing.import_case(database, elsewhere, archive, {}) == (live.case_id, True)
        with database.read() as connection:
            last = store.newest_event(connection, live.case_id)
            assert (last.state, last.trigger, last.case_state["target"]) == (State.SAFE_HOLD, "restarted", None)
    other = make_site(tmp_path / "other", State.REGISTERED)
    second = _export(other.folder, other.case_id, tmp_path / "other.zip")
    refused = _run("import", second, "--data-folder", elsewhere.data_folder)
    assert refused.exit_code == 3
    assert "case_open" in refused.stderr


def test_a_pseudonymised_archive_names_nobody_and_says_what_it_is_not(site, tmp_path, elsewhere) -> None:
    overridden = NewVerdict("image_age", "H03", True, 1900.0, 3600.0, "s", "overridden: Mrs Roe lies still")
    with current_database(site.settings) as database, database.write() as connection:
        record_attempt(
            connection,
            NewAttempt(site.case_id, None, "move_approved", True, "taken", "Mrs Roe", State.CLOSED, (overridden,)),
        )
    plain = _export(site.folder, site.case_id, tmp_path / "plain.zip")
    hidden = _export(site.folder, site.case_id, tmp_path / "hidden.zip", "--pseudonymise")
    content = hidden.read_bytes()
    for word in (b"Doe", b"Roe", b"L3 left", b"anna", b"1.2.3", b"CARM"):
        assert word in plain.read_bytes()
        assert word not in content, word
    verified = _run("verify", hidden)
    assert verified.exit_code == 0
    assert "no hash or signature of the ledger fits them" in verified.stdout
    with open_archive(hidden) as archive:
        images = [archive.read(name) for name in archive.names if name.endswith(".dcm")]
        (row,) = archive.objects("rows/cases.jsonl")
    (patient,) = {pydicom.dcmread(io.BytesIO(one)).PatientID for one in images}
    assert patient == row["patient_id"] != "P1"
    assert _run("import", hidden, "--data-folder", elsewhere.data_folder).exit_code == 0
    replayed = CliRunner().invoke(audit, ["replay", site.case_id, "--data-folder", str(elsewhere.data_folder)])
    assert replayed.exit_code == 0, replayed.output


def test_the_auditor_gets_the_archive_over_http(serving, site, tmp_path) -> None:
    ports = {"http": HttpSettings(port=0), "dicom": DicomSettings(port=0)}
    settings = site.settings.model_copy(update=ports)
    with serving(settings) as service:
        with service.client(Role.AUDITOR) as auditor:
            answer = auditor.get(f"/cases/{site.case_id}/export")
            unknown = auditor.get("/cases/none/export")
        with service.client(Role.OPERATOR) as operator:
            refused = operator.get(f"/cases/{site.case_id}/export")
    assert (refused.status_code, unknown.status_code) == (403, 404)
    (tmp_path / "got.zip").write_bytes(answer.content)
    assert check_file(tmp_path / "got.zip", {}).findings == []
    assert answer.headers["content-disposition"] == f'attachment; filename="case-{site.case_id}.zip"'
