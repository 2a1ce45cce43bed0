"""What an entry says, when one is written, and when it is signed."""

import json
import re
from pathlib import Path

import pytest
import rfc8785
import sqlalchemy as sa

import service
from coaxial_client import Coaxial
from service.audit import record_audit
from service.auth.permissions import Role
from service.cases import store
from service.cases.records import NewCase, NewEvent
from service.database import tables
from service.ledger.checkpoints import CHECKPOINT_EVERY, sign_head
from service.ledger.entries import head_of
from service.ledger.keys import signing_key
from service.ledger.speaker import SPEAKER, speak_as
from service.ledger.verifying import verify

_RECORD_NAMES = "|".join(table.name for table in tables.RECORDS)


def _entries(database):
    query = sa.select(tables.ledger.c.entry).order_by(tables.ledger.c.sequence)
    with database.read() as connection:
        return [json.loads(text) for text in connection.execute(query).scalars()]


def _checkpoints(database):
    with database.read() as connection:
        texts = connection.execute(sa.select(tables.checkpoints.c.statement)).scalars()
        return [json.loads(text) for text in texts]


def test_a_transaction_leaves_one_entry_over_all_its_rows(database, users):
    surgeon = users.add("anna", Role.SURGEON, "correct horse", "2468")
    token = SPEAKER.set("service")
    speak_as("192.0.2.7", "tablet/1")
    case = NewCase("case-1", "room-1", "P1", "1.2", surgeon.id, "0" * 64, {}, {"L3": {"a": 1}})
    with database.write() as connection:
        store.open_case(connection, case, NewEvent("case_opened", surgeon.id, "case_open", {}, {}))
    SPEAKER.reset(token)
    *_, entry = _entries(database)
    said = {name: entry[name] for name in ("action", "actor_name", "role", "client", "case_id", "before", "after")}
    assert said == {
        "action": "case_opened",
        "actor_name": "anna",
        "role": "surgeon",
        "client": "192.0.2.7 tablet/1",
        "case_id": "case-1",
        "before": None,
        "after": "case_open",
    }
    assert {name: [key for key, _ in rows] for name, rows in entry["rows"].items()} == {
        "cases": [["case-1"]],
        "events": [["case-1", 1]],
        "planned_targets": [["case-1"]],
    }


def test_an_entry_is_canonical_json_whatever_is_recorded(database):
    odd = {"nan": float("nan"), "large": 2**80, "e": 1e-7, "whole": 5.0, "ü\u2028": ["\x07", None, True]}
    with database.write() as connection:
        record_audit(connection, "odd", None, odd)
    with database.read() as connection:
        text = connection.execute(sa.select(tables.ledger.c.entry).order_by(tables.ledger.c.sequence.desc())).scalar()
    assert rfc8785.dumps(json.loads(text)).decode() == text


def test_what_is_rolled_back_or_adds_no_record_leaves_no_entry(database):
    before = _entries(database)
    with pytest.raises(sa.exc.IntegrityError), database.write() as connection:
        _record_then_fail(connection)
    with database.write() as connection:
        connection.execute(sa.insert(tables.lock_outs).values(subject="x", until_s=1.0))
    assert _entries(database) == before


def _record_then_fail(connection):
    record_audit(connection, "odd", None, {})
    for _ in range(2):
        connection.execute(sa.insert(tables.lock_outs).values(subject="twice", until_s=1.0))


def test_record_rows_are_added_in_one_place_only():
    """Any other INSERT would be a row that no entry vouches for."""
    inserts = re.compile(rf"insert\(\s*(tables\.)?({_RECORD_NAMES})\b|insert into ({_RECORD_NAMES})\b", re.IGNORECASE)
    folder = Path(service.__file__).parent
    assert [file.name for file in folder.rglob("*.py") if inserts.search(file.read_text())] == []


def test_every_thousandth_entry_is_signed(database, tmp_path):
    database.signer = signing_key(tmp_path / "signing.key")
    for _ in range(3):
        with database.write() as connection:
            record_audit(connection, "odd", None, {})
    assert _checkpoints(database) == []
    with database.write() as connection:  # the ledger as it would be shortly before
        last = head_of(connection)
        values = {"sequence": CHECKPOINT_EVERY - 1, "entry": "{}", "sha256": last.sha256, "action": "x"}
        connection.execute(sa.insert(tables.ledger).values(values | {"reached_at": last.reached_at}))
    with database.write() as connection:
        record_audit(connection, "odd", None, {})
    assert [(one["sequence"], one["reason"]) for one in _checkpoints(database)] == [(CHECKPOINT_EVERY, "count")]


def test_the_same_entry_is_signed_once(database, tmp_path):
    signer = signing_key(tmp_path / "signing.key")
    for reason in ("hour", "end"):
        with database.write() as connection:
            sign_head(connection, head_of(connection), signer, reason)
    assert [one["reason"] for one in _checkpoints(database)] == ["hour"]


def test_closing_a_case_signs_a_checkpoint_with_it(running, device_files):
    """Row 42."""
    with Coaxial(running.url) as surgeon:
        surgeon.sign_in("surgeon", "correct horse")
        for kind, content in device_files.items():
            surgeon.upload_device(kind, content.encode())
        target = {"name": "L3", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}
        case = surgeon.open_case({"patient_id": "P1", "study_uid": "1.2.3", "targets": [target]})
        case.command("guide-state-stated", guide="empty")
        case.command("case-closed", pin="2468", abandoned={"L3": "end of the test"})
    database = running.parts.database
    closing = next(entry for entry in _entries(database) if entry["after"] == "closed")
    signed = {one["sequence"]: one["reason"] for one in _checkpoints(database)}
    assert signed[closing["sequence"]] == "case_closed"
    verifier, anchor = database.signer.verifier, running.parts.settings.anchor_file
    assert verify(database, {verifier.name: verifier}, anchor).findings == []
