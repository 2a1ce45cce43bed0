"""Without its key a signed record is read as before, and nothing signs it with another unless somebody says so."""

import asyncio
import shutil
from contextlib import closing

import pytest
from typer.testing import CliRunner

from service.app import create_app
from service.audit import record_audit
from service.cli.main import app
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.ledger.entries import head_of
from service.settings import DicomSettings, HttpSettings, Settings


@pytest.fixture
def settings(record, tmp_path) -> Settings:
    """A restored folder: the database alone."""
    ports = {"http": HttpSettings(port=0), "dicom": DicomSettings(port=0)}
    return Settings(data_folder=tmp_path / "restored", database_url=record.address, min_free_bytes=0, **ports)


@pytest.fixture
def run(settings, monkeypatch):
    monkeypatch.setenv("COAXIAL_MIN_FREE_BYTES", "0")
    monkeypatch.setenv("COAXIAL_DATABASE_URL", settings.database_url)
    monkeypatch.setenv("COAXIAL_PASSWORD", "correct horse")
    monkeypatch.setenv("COAXIAL_PIN", "2468")
    return lambda *words: CliRunner().invoke(app, [*map(str, words), "--data-folder", str(settings.data_folder)])


READING = (
    ("user", "list"),
    ("audit", "list"),
    ("audit", "export"),
    ("audit", "key"),
    ("audit", "replay", "case-1"),
    ("db", "upgrade"),
    ("doctor",),
)
SIGNING = (
    ("user", "add", "berta", "--role", "surgeon"),
    ("case", "export", "case-1", "--out", "case.zip"),
)


def test_commands_that_read_make_no_key_and_the_record_stays_sound(run, settings, record, kept_record, tmp_path):
    for words in READING:
        run(*words)
    run("db", "backup", tmp_path / "backup")
    assert run("user", "list").exit_code == run("audit", "list").exit_code == 0
    assert not settings.key_file.exists()
    kept = ("--public-key", kept_record.folder / "signing.pub", "--anchor", record.anchor)
    verified = run("audit", "verify", "--workers", "1", *kept)
    assert (verified.exit_code, verified.stdout.rstrip().endswith("nothing found")) == (0, True), verified.output
    assert not settings.key_file.exists()


def test_verifying_without_any_key_names_the_one_that_is_missing(run, settings):
    refused = run("audit", "verify", "--workers", "1")
    assert (refused.exit_code, refused.stderr.split(":")[0]) == (3, ErrorCode.KEY_MISSING)
    assert f"{settings.key_file.with_suffix('.pub')} is not here" in refused.stderr
    assert "--public-key" in refused.stderr
    unreadable = run("audit", "verify", "--workers", "1", "--public-key", settings.data_folder)
    assert unreadable.stderr.split(":")[0] == ErrorCode.KEY_REFUSED


@pytest.mark.parametrize("words", SIGNING, ids=lambda words: words[0])
def test_a_command_that_signs_names_the_file_that_is_missing_and_makes_none(run, settings, words):
    refused = run(*words)
    assert (refused.exit_code, refused.stderr.split(":")[0]) == (3, ErrorCode.KEY_MISSING)
    assert str(settings.key_file) in refused.stderr
    assert not settings.key_file.exists()


def test_the_service_does_not_start_without_the_key_of_its_record(settings):
    service = create_app(settings)

    async def start() -> None:
        async with service.router.lifespan_context(service):
            pass

    with pytest.raises(ServiceError) as refused:
        asyncio.run(start())
    assert refused.value.code == ErrorCode.KEY_MISSING
    assert not settings.key_file.exists()


def test_with_its_key_the_record_goes_on(run, settings, kept_record):
    settings.key_file.parent.mkdir(parents=True, mode=0o700)
    for name in ("signing.key", "signing.pub"):
        shutil.copy2(kept_record.folder / name, settings.key_file.parent / name)
    assert run(*SIGNING[0]).exit_code == 0
    assert run("audit", "verify", "--workers", "1").stdout.rstrip().endswith("nothing found")


def test_who_upgrades_an_empty_database_leaves_the_key_to_the_service(run, settings, databases, tmp_path, monkeypatch):
    with databases.empty(tmp_path / "restored") as address:
        monkeypatch.setenv("COAXIAL_DATABASE_URL", address)
        assert run("db", "upgrade").exit_code == 0
        assert not settings.key_file.exists()
        assert run(*SIGNING[0]).exit_code == 0
        assert run("audit", "verify", "--workers", "1").stdout.rstrip().endswith("nothing found")


def test_a_new_key_is_made_when_told_so_and_vouches_with_the_old_one(run, settings, kept_record):
    assert run("audit", "key").exit_code == 3
    assert run("audit", "key", "--new").exit_code == 0
    made = settings.key_file.read_bytes()
    assert run("audit", "key", "--new").stdout == run("audit", "key").stdout
    assert settings.key_file.read_bytes() == made, "made once"
    assert run(*SIGNING[0]).exit_code == 0
    alone = run("audit", "verify", "--workers", "1")
    assert "signed by an unknown key" in alone.stdout
    both = ("--public-key", kept_record.folder / "signing.pub", "--public-key", settings.key_file.with_suffix(".pub"))
    assert run("audit", "verify", "--workers", "1", *both).stdout.rstrip().endswith("nothing found")


def test_without_a_key_no_entry_that_is_always_signed_is_written(record):
    with closing(record.open()) as database:
        keyless = Database(database.writer, database.reader)
        with keyless.read() as connection:
            newest = head_of(connection).sequence
        for _ in range(newest + 1, 1000):
            with keyless.write() as connection:
                record_audit(connection, "noted", None, {})
        with pytest.raises(ServiceError) as refused, keyless.write() as connection:
            record_audit(connection, "noted", None, {})
        assert (refused.value.code, refused.value.measured) == (ErrorCode.KEY_MISSING, 1000)
        with keyless.read() as connection:
            assert head_of(connection).sequence == 999
