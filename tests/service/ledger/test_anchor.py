"""The anchor follows the ledger, and is evidence once the two contradict each other."""

import json

from service.audit import record_audit
from service.ledger.anchor import advance_anchor, read_anchor


def _grow(database):
    with database.write() as connection:
        record_audit(connection, "signed_in", None, {})


def _anchored(record):
    return read_anchor(record.anchor, {record.signer.verifier.name: record.signer.verifier}).sequence


def test_the_anchor_follows_the_newest_entry(record):
    database, before = record.open(), _anchored(record)
    _grow(database)
    advance_anchor(database, record.anchor, record.signer)
    assert _anchored(record) == before + 1
    record.anchor.unlink()
    advance_anchor(database, record.anchor, record.signer)
    assert _anchored(record) == before + 1
    database.close()


def test_an_anchor_that_the_database_contradicts_is_kept(record):
    kept = record.anchor.read_text()

    def cut(connection):
        connection.execute("DELETE FROM ledger WHERE sequence = (SELECT max(sequence) FROM ledger)")
        connection.execute("DELETE FROM audit_events WHERE id = (SELECT max(id) FROM audit_events)")

    record.attack(cut)
    database = record.open()
    for _ in range(3):  # beyond the anchored number again
        _grow(database)
        advance_anchor(database, record.anchor, record.signer)
    database.close()
    assert record.anchor.read_text() == kept
    assert record.wheres() == {"anchor"}


def test_an_anchor_of_another_hand_is_kept_and_an_absent_disk_stops_nothing(record, tmp_path):
    kept = json.dumps({"statement": "{}", "signature": ""})
    record.anchor.write_text(kept)
    database = record.open()
    advance_anchor(database, record.anchor, record.signer)
    assert record.anchor.read_text() == kept
    blocked = tmp_path / "file"
    blocked.write_text("")
    advance_anchor(database, blocked / "head.json", record.signer)
    database.close()


def test_entries_that_were_added_past_the_service_are_newer_than_the_anchor(record):
    """Without the key nobody can tell them from a command's; the number shows that they are there."""
    database, before = record.open(), _anchored(record)
    _grow(database)
    database.close()
    assert record.findings() == []
    assert _anchored(record) == before
    assert max(row.sequence for row in record.rows()["ledger"]) == before + 1
