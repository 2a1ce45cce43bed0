"""Commands on the record that are given what they cannot use: one line that says what to do, and nothing half-made."""

import getpass
import os
import sqlite3
from pathlib import Path

import orjson
import pytest
import sqlalchemy as sa
import typer
from typer.testing import CliRunner, Result

from service.cli.main import app
from service.cli.streams import write_file
from service.database import tables
from service.database.current import current_database
from service.database.engines import open_database
from service.database.migrate import version_of
from service.settings import Settings


@pytest.fixture
def run(tmp_path, monkeypatch):
    """The command, with nothing of this machine's."""
    monkeypatch.setenv("COAXIAL_MIN_FREE_BYTES", "0")
    monkeypatch.delenv("COAXIAL_DATABASE_URL", raising=False)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("text")
    (tmp_path / "folder").mkdir()

    def call(*arguments: str) -> Result:
        return CliRunner().invoke(app, arguments)

    return call


@pytest.mark.parametrize(
    ("command", "code"),
    [
        ("audit list --data-folder file", "database_missing"),
        ("db upgrade --data-folder file/below", "settings_refused"),
        ("db restore file --data-folder file", "backup_refused"),
        ("audit key --data-folder file", "key_missing"),
        ("audit key --new --data-folder file", "key_refused"),
        ("audit verify --data-folder folder", "database_missing"),
        ("audit verify --data-folder folder --public-key folder", "database_missing"),
        ("case verify none", "archive_refused"),
        ("case verify folder", "archive_refused"),
        ("case verify file --public-key none", "archive_refused"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(run, command, code):
    refused = run(*command.split())
    (line,) = refused.stderr.splitlines()
    assert (refused.exit_code, line.split(":")[0]) == (3, code)
    assert line.endswith(".")


@pytest.mark.parametrize(
    "command",
    [
        "audit list",
        "audit export",
        "audit verify",
        "trends",
        "user list",
        "user disable anna",
        "db backup X",
        "case export X --out X.zip",
        "case report X",
        "audit replay X",
    ],
)
def test_a_mistyped_folder_is_refused_and_gets_no_database(run, tmp_path, command):
    refused = run(*command.split(), "--data-folder", "fodler")
    assert refused.exit_code != 0
    assert "database_missing: there is no database" in refused.stderr
    assert "is the data folder the one meant? Name the folder with --data-folder" in refused.stderr
    assert not (tmp_path / "fodler").exists()


@pytest.mark.parametrize("given", ["none", "file"])
def test_restoring_from_no_backup_makes_no_database_that_passes_for_the_room_s(run, tmp_path, given):
    refused = run("db", "restore", given, "--data-folder", "room")
    assert (refused.exit_code, refused.stderr.split(":")[0]) == (3, "backup_refused")
    assert not (tmp_path / "room").exists()


def test_verifying_says_that_a_database_is_older_and_leaves_it_so(run, tmp_path):
    settings = Settings(data_folder=tmp_path / "folder")
    with sqlite3.connect(tmp_path / "folder" / "coaxial.sqlite") as old:
        old.executescript((Path(__file__).parent / "released" / "0001.sqlite.sql").read_text())
    refused = run("audit", "verify", "--data-folder", "folder")
    assert refused.stderr.startswith("schema_old: the database is older than this program")
    database = open_database(settings.database_url)
    assert version_of(database) == "0001"
    database.close()


@pytest.mark.parametrize("name", ["none", "folder"])
def test_a_file_that_cannot_be_read_is_told_from_one_that_is_no_archive(run, name):
    assert "cannot be read" in run("case", "verify", name).stderr
    assert "is no archive" in run("case", "verify", "file").stderr


def test_a_database_out_of_reach_says_why_and_no_password(run, monkeypatch):
    monkeypatch.setenv("COAXIAL_DATABASE_URL", "postgresql://a:secret@127.0.0.9:1/x")
    refused = run("user", "list", "--data-folder", "folder")
    assert (refused.exit_code, refused.stderr.split(":")[0]) == (3, "database_fault")
    assert "refused" in refused.stderr
    assert "secret" not in refused.stderr


def test_a_new_data_folder_is_its_owner_s_alone(run, tmp_path):
    assert run("db", "upgrade", "--data-folder", "new/data").exit_code == 0
    assert (tmp_path / "new" / "data").stat().st_mode & 0o077 == 0


def test_who_added_a_user_at_the_machine_is_in_the_record(run, tmp_path, monkeypatch):
    monkeypatch.setenv("COAXIAL_PASSWORD", "correct horse")
    monkeypatch.setenv("COAXIAL_PIN", "2468")
    assert run("user", "add", "anna", "--role", "surgeon", "--data-folder", "folder").exit_code == 0
    settings = Settings(data_folder=tmp_path / "folder", min_free_bytes=0)
    with current_database(settings) as database, database.read() as connection:
        entries = [orjson.loads(text) for text in connection.execute(sa.select(tables.ledger.c.entry)).scalars()]
    (added,) = (entry for entry in entries if entry["action"] == "user_added")
    assert added["client"] == f"command line {getpass.getuser()}"


def test_a_report_that_cannot_be_written_ends_with_one_line_and_leaves_the_old_one(tmp_path, monkeypatch):
    """As every file that a command writes: whole, or not at all."""
    old = tmp_path / "report.pdf"
    write_file(old, b"old")

    def full(self: Path, data: bytes) -> int:
        with self.open("wb") as opened:
            opened.write(data[:1])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(typer.Exit):
        write_file(old, b"new")
    assert old.read_bytes() == b"old"
    assert [one.name for one in tmp_path.iterdir()] == ["report.pdf"]


def test_a_file_takes_no_device_s_place_and_goes_where_a_link_leads(tmp_path, capsys):
    """As the superuser a report would else take the place of /dev/stdout, for everybody."""
    pipe, link, old = tmp_path / "pipe", tmp_path / "link", tmp_path / "old"
    os.mkfifo(pipe)
    with pytest.raises(typer.Exit):
        write_file(pipe, b"new")
    assert capsys.readouterr().err == f"error: {pipe}: a device or a pipe, and no file\n"
    assert pipe.is_fifo()
    old.write_bytes(b"old")
    link.symlink_to(old)
    write_file(link, b"new")
    assert link.is_symlink()
    assert old.read_bytes() == b"new"
    circle = tmp_path / "circle"
    circle.symlink_to(circle)
    with pytest.raises(typer.Exit):
        write_file(circle, b"new")
    assert circle.is_symlink()
