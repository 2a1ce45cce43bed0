"""`coaxial audit` on a whole data folder."""

import json
import shutil

import pytest
from typer.testing import CliRunner

from service.cli.audit import audit


@pytest.fixture
def folder(record, kept_record):
    """As the service leaves it: database, key and anchor where the settings look for them."""
    (record.folder / "audit").mkdir(mode=0o700)
    for name in ("signing.key", "signing.pub"):
        shutil.copy2(kept_record.folder / name, record.folder / "audit" / name)
    shutil.move(record.anchor, record.folder / "audit" / "head.json")
    return record.folder


@pytest.fixture
def run(record, folder, monkeypatch):
    monkeypatch.setenv("COAXIAL_MIN_FREE_BYTES", "0")
    monkeypatch.setenv("COAXIAL_DATABASE_URL", record.address)
    return lambda *arguments: CliRunner().invoke(audit, [*arguments, "--data-folder", str(folder)])


def test_a_whole_record_verifies_and_that_is_recorded(run):
    for _ in range(2):
        result = run("verify", "--workers", "1")
        assert result.exit_code == 0, result.output
        assert result.stdout.rstrip().endswith("nothing found")
    listed = run("list", "--format", "jsonl", "--action", "ledger_verified")
    (first, _) = [json.loads(line) for line in listed.stdout.splitlines()]
    assert first["payload"]["findings"] == 0
    assert first["client"].startswith("command line ")


def test_what_was_changed_is_printed_with_its_place_and_status_1(run, record):
    record.attack(lambda c: c.execute("UPDATE events SET state = 'moved' WHERE case_id = 'case-1' AND sequence = 3"))
    result = run("verify", "--workers", "1")
    assert result.exit_code == 1
    assert result.stdout.startswith("events case-1/3: not what entry ")


def test_a_key_kept_elsewhere_verifies_and_another_does_not(run, folder, tmp_path):
    kept = tmp_path / "kept.pem"
    kept.write_text(run("key").stdout)
    assert run("verify", "--workers", "1", "--public-key", str(kept)).exit_code == 0
    other = CliRunner().invoke(audit, ["key", "--new", "--data-folder", str(tmp_path / "other")])
    kept.write_text(other.stdout)
    result = run("verify", "--workers", "1", "--public-key", str(kept))
    assert result.exit_code == 1
    assert "signed by an unknown key" in result.stdout


def test_several_processes_find_the_same(run, record, monkeypatch):
    monkeypatch.setattr("service.ledger.parts_check._A_PART", 10)
    record.attack(lambda c: c.execute("DELETE FROM ledger WHERE sequence BETWEEN 8 AND 13"))
    alone, together = (run("verify", "--workers", count).stdout.splitlines()[:-1] for count in ("1", "2"))
    assert alone == together
    assert "entry 8: missing up to entry 13: deleted, or never there" in alone


def test_a_key_for_others_is_refused(run, folder):
    (folder / "audit" / "signing.key").chmod(0o644)
    result = run("list")
    assert result.exit_code == 3
    assert "key_refused" in result.stderr


def test_a_list_ends_at_its_limit_and_says_where_it_goes_on(run):
    cut = run("list", "--limit", "3", "--case", "case-1")
    *_, last = cut.stdout.splitlines()
    assert len(cut.stdout.splitlines()) == 1 + 3
    assert cut.stderr == f"3 entries, and there are more: --after {last.split(',')[0]}\n"
    whole = run("list", "--limit", "0", "--case", "case-1")
    count = len(whole.stdout.splitlines()) - 1
    assert count > 3
    assert whole.stderr == ""
    assert run("list", "--limit", str(count), "--case", "case-1").stderr == ""


def test_a_list_of_nothing_says_so(run):
    assert run("list", "--case", "case-1").stderr == ""
    assert run("list", "--case", "none").stderr == "no entry fits\n"
    assert run("export", "--hazard", "H99").stderr == "no entry fits\n"


@pytest.mark.parametrize("form", ["jsonl", "csv", "dicom", "fhir"])
def test_an_export_prints_every_entry_and_is_one_itself(run, form):
    lines = run("export", "--format", form, "--case", "case-1").stdout.splitlines()
    listed = run("list", "--format", "jsonl", "--limit", "0", "--case", "case-1").stdout.splitlines()
    assert len(lines) == len(listed) + (form == "csv")
    (read,) = [
        json.loads(line) for line in run("list", "--format", "jsonl", "--action", "log_read").stdout.splitlines()
    ][:1]
    assert read["payload"] == {"what": "audit export", "asked": {"after": 0, "format": form, "limit": None}}
