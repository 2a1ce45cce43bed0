"""H26: whoever has the database and not the key changes nothing that a verification does not find, and place."""

import dataclasses
import hashlib
import json
import random
from contextlib import closing

import pytest
import rfc8785
import sqlalchemy as sa
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

from service.audit import record_audit
from service.database import tables
from service.database.engines import open_database
from service.database.migrate import migrate
from service.ledger.anchor import advance_anchor
from service.ledger.checkpoints import sign_head, statement_on
from service.ledger.entries import Head, head_of
from service.ledger.keys import Signer, Verifier, signing_key
from service.ledger.verifying import verify
from tests.databases import ALL, file_of

_COLUMNS = [column for table in ALL for column in table.columns]
_TEXTS = [column for column in _COLUMNS if isinstance(column.type, (sa.Text, sa.String, sa.JSON))]
_FILE_FLIPS = 40


def _flipped(value):
    """The value with one bit changed; what is missing appears, and JSON too short for that gains a blank."""
    match value:
        case None | "":
            return "7"
        case int():
            return type(value)(value ^ 1)
        case float():
            return value + abs(value) * 2**-50
        case bytes():
            return bytes([value[0] ^ 1]) + value[1:]
        case _:
            changed = (value[:at] + chr(ord(value[at]) ^ 1) + value[at + 1 :] for at in range(len(value) // 2, -1, -1))
            return next((text for text in changed if _is_json(text) or not _is_json(value)), f"{value} ")


def _is_json(text):
    """PostgreSQL keeps nothing else in a JSON column."""
    try:
        json.loads(text)
    except ValueError:
        return False
    return True


def test_an_untouched_record_is_whole(record):
    assert record.findings() == []


def _flip(column, flipped, marker="?"):
    """An attack on the first row that has a value."""
    table = column.table.name
    read = f'CAST("{column.name}" AS TEXT)' if isinstance(column.type, sa.JSON) else f'"{column.name}"'

    def flip(attacker):
        query = f'SELECT rowid, {read} FROM {table} ORDER BY "{column.name}" IS NULL, rowid LIMIT 1'
        row, value = attacker.execute(query).fetchone()
        attacker.execute(f'UPDATE {table} SET "{column.name}" = {marker} WHERE rowid = ?', [flipped(value), row])

    return flip


def _names(wheres, table):
    places = {"ledger": ("entry", "missing"), "checkpoints": ("checkpoint",)}.get(table.name, (table.name,))
    return any(where.startswith(places) for where in wheres)


@pytest.mark.hazard("H26")
@pytest.mark.parametrize("column", _COLUMNS, ids=str)
def test_a_flipped_bit_is_found_in_every_column(record, column):
    record.attack(_flip(column, _flipped))
    assert _names(record.wheres(), column.table)


@pytest.mark.sqlite
@pytest.mark.parametrize("column", _TEXTS[::6], ids=str)
def test_a_text_that_is_no_utf_8_any_more_is_found(record, column):
    record.attack(_flip(column, lambda text: (text or "x")[:-1].encode() + b"\xff", "CAST(? AS TEXT)"))
    assert _names(record.wheres(), column.table)


@pytest.mark.sqlite
@pytest.mark.parametrize("seed", range(_FILE_FLIPS))
def test_a_bit_flipped_anywhere_in_the_file_is_found_or_changes_no_record(record, kept_record, seed):
    file = file_of(record.address)
    content = bytearray(file.read_bytes())
    place = random.Random(seed).randrange(len(content) * 8)
    content[place // 8] ^= 1 << place % 8
    file.write_bytes(content)
    try:
        found = record.findings()
    except Exception as error:  # noqa: BLE001  # a file that no longer opens is found, too
        found = [error]
    assert found or record.rows() == kept_record.rows()


@pytest.mark.hazard("H26")
@pytest.mark.parametrize("table", tables.RECORDS, ids=lambda table: table.name)
def test_a_deleted_row_is_named(record, table):
    record.attack(lambda c: c.execute(f"DELETE FROM {table.name} WHERE rowid = (SELECT max(rowid) FROM {table.name})"))
    (where,) = record.wheres()
    assert where.startswith(f"{table.name} ")


@pytest.mark.hazard("H26")
@pytest.mark.parametrize("table", tables.RECORDS, ids=lambda table: table.name)
def test_an_inserted_row_is_named(record, table):
    names = ", ".join(f'"{column.name}"' for column in table.columns)
    forged = {"sequence": "777", "position": "777", "sha256": "'f'", "name": "'forged'", "image_id": "'forged'"}
    forged["id"] = "777" if table.columns[0].type.python_type is int else "'forged'"
    values = ", ".join(forged.get(column.name, f'"{column.name}"') for column in table.columns)
    record.attack(lambda c: c.execute(f"INSERT INTO {table.name} ({names}) SELECT {values} FROM {table.name} LIMIT 1"))
    assert any(where.startswith(f"{table.name} ") for where in record.wheres())


@pytest.mark.hazard("H26")
def test_two_rows_with_their_contents_swapped_are_both_named(record):
    def swap(connection):
        rows = dict(connection.execute("SELECT sequence, recorded_at FROM events WHERE case_id = 'case-1'"))
        for sequence, other in ((3, 4), (4, 3)):
            query = "UPDATE events SET recorded_at = ? WHERE case_id = 'case-1' AND sequence = ?"
            connection.execute(query, [rows[other], sequence])

    record.attack(swap)
    assert record.wheres() == {"events case-1/3", "events case-1/4"}


@pytest.mark.hazard("H26")
def test_two_swapped_entries_are_both_named(record):
    def swap(connection):
        rows = dict(connection.execute("SELECT sequence, entry FROM ledger WHERE sequence IN (5, 6)"))
        for sequence, other in ((5, 6), (6, 5)):
            connection.execute("UPDATE ledger SET entry = ? WHERE sequence = ?", [rows[other], sequence])

    record.attack(swap)
    assert record.wheres() >= {"entry 5", "entry 6"}


@pytest.mark.hazard("H26")
def test_a_deleted_entry_is_named(record):
    record.attack(lambda c: c.execute("DELETE FROM ledger WHERE sequence = 7"))
    assert "entry 7" in record.wheres()


def test_a_deleted_checkpoint_is_named(record):
    record.attack(lambda c: c.execute("DELETE FROM checkpoints WHERE sequence = 1"))
    (finding,) = record.findings()
    assert "one is missing" in finding.what
    record.attack(lambda c: c.execute("DELETE FROM checkpoints"))
    assert any("always signed" in finding.what for finding in record.findings())


@pytest.mark.hazard("H26")
def test_a_cut_end_is_seen_by_the_anchor(record):
    """The last transaction, with its entry and its row: what is left is consistent in itself."""

    def cut(connection):
        connection.execute("DELETE FROM ledger WHERE sequence = (SELECT max(sequence) FROM ledger)")
        connection.execute("DELETE FROM audit_events WHERE id = (SELECT max(id) FROM audit_events)")

    record.attack(cut)
    (finding,) = record.findings()
    assert finding.where == "anchor"
    assert "the end was cut off" in finding.what


@pytest.mark.hazard("H26")
def test_an_old_copy_is_seen_by_the_anchor(record, kept_record):
    with closing(record.open()) as database:
        with database.write() as connection:
            record_audit(connection, "signed_in", None, {})
        advance_anchor(database, record.anchor, record.signer)
    assert record.findings() == []
    assert dataclasses.replace(record, address=kept_record.address).wheres() == {"anchor"}


def _rehash(connection, first, change):
    """Change an entry and write every later one anew, so that the chain holds."""
    later = "SELECT sequence, entry FROM ledger WHERE sequence >= ? ORDER BY sequence"
    rows = connection.execute(later, [first]).fetchall()
    previous = json.loads(rows[0][1])["previous"]
    for sequence, text in rows:
        entry = json.loads(text) | {"previous": previous}
        if sequence == first:
            change(entry)
        text = rfc8785.dumps(entry).decode()
        previous = hashlib.sha256(text.encode()).hexdigest()
        connection.execute(
            "UPDATE ledger SET entry = ?, sha256 = ?, action = ? WHERE sequence = ?",
            [text, previous, entry["action"], sequence],
        )


def _rename(entry):
    entry["action"] = "forged"


@pytest.mark.hazard("H26")
def test_a_history_hashed_anew_without_the_key_is_not_what_was_signed(record):
    record.attack(lambda connection: _rehash(connection, 4, _rename))
    findings = record.findings()
    assert {finding.where.split()[0] for finding in findings} == {"entries", "anchor"}
    assert findings[0].where.startswith("entries 2 to ")


@pytest.mark.parametrize(
    "change",
    [
        lambda entry: entry.pop("sequence"),
        lambda entry: entry.update(rows=5),
        lambda entry: entry.update(rows={"events": 5}),
        lambda entry: entry.update(rows={"events": [[[{}], "0"]]}),
        lambda entry: entry.update(rows={"events": [[["case-1"], 0]]}),
    ],
)
def test_an_entry_of_another_shape_is_a_finding_and_ends_no_verification(record, change):
    record.attack(lambda connection: _rehash(connection, 7, change))
    wheres = record.wheres()
    assert "entry 7" in wheres
    assert any(where.startswith("entries ") for where in wheres)


def test_an_unsigned_end_hashed_anew_is_not_what_was_anchored(record):
    def rehash(connection):
        (newest,) = connection.execute("SELECT max(sequence) FROM ledger").fetchone()
        _rehash(connection, newest, _rename)

    record.attack(rehash)
    (finding,) = record.findings()
    assert finding.where == "anchor"
    assert "written anew" in finding.what


@pytest.mark.hazard("H26")
def test_checkpoints_signed_anew_with_another_key_are_unknown(record):
    key = Ed25519PrivateKey.generate()
    other = Signer(key, Verifier(key.public_key()))

    def rewrite(connection):
        _rehash(connection, 4, _rename)
        last = 0
        for (sequence,) in connection.execute("SELECT sequence FROM checkpoints ORDER BY sequence").fetchall():
            (sha256,) = connection.execute("SELECT sha256 FROM ledger WHERE sequence = ?", [sequence]).fetchone()
            statement = statement_on(Head(sequence, sha256, ""), other, reason="count", previous=last)
            values = [statement, other.sign(statement), sequence]
            connection.execute("UPDATE checkpoints SET statement = ?, signature = ? WHERE sequence = ?", values)
            last = sequence

    record.attack(rewrite)
    assert any("unknown key" in finding.what for finding in record.findings())


def test_a_missing_or_forged_anchor_is_a_finding(record):
    kept = json.loads(record.anchor.read_text())
    record.anchor.write_text(json.dumps(kept | {"statement": kept["statement"].replace('"sequence":', '"sequence":1')}))
    assert record.wheres() == {"anchor"}
    record.anchor.write_text("no anchor")
    assert record.wheres() == {"anchor"}
    record.anchor.unlink()
    assert record.wheres() == {"anchor"}


def test_an_emptied_record_is_no_new_record(record):
    def empty(connection):
        for table in ALL:
            connection.execute(f"DELETE FROM {table.name}")

    record.attack(empty)
    assert {"ledger", "anchor"} <= record.wheres()


@pytest.fixture
def small(databases, tmp_path):
    """A record of one event, signed and anchored, and what verifies it."""
    signer = signing_key(tmp_path / "signing.key")
    with databases.empty(tmp_path) as address, closing(open_database(address, signer)) as database:
        migrate(database)
        with database.write() as connection:
            record_audit(connection, "noted", None, {"text": "µ"})
        with database.write() as connection:
            sign_head(connection, head_of(connection), signer, "end")
        advance_anchor(database, tmp_path / "head.json", signer)
        yield (
            address,
            lambda: verify(database, {signer.verifier.name: signer.verifier}, tmp_path / "head.json").findings,
        )


@pytest.mark.sqlite
@pytest.mark.parametrize("table", ["audit_events", "ledger", "checkpoints"])
def test_no_byte_of_a_small_record_bears_a_flipped_bit(small, databases, table):
    """Every byte of every text that the newest row holds, each bit in turn."""
    address, findings = small
    unseen = []
    assert findings() == []
    with databases.attack(address) as attacker:
        attacker.commit()
        of_the_attack = findings()  # that the triggers are gone
        columns = [name for _, name, kind, *_ in attacker.execute(f"PRAGMA table_info({table})") if "INT" not in kind]
        row, *values = attacker.execute(
            f"SELECT rowid, {', '.join(columns)} FROM {table} ORDER BY rowid DESC LIMIT 1"
        ).fetchone()
        for column, value in zip(columns, values, strict=True):
            update = f"UPDATE {table} SET {column} = CAST(? AS TEXT) WHERE rowid = ?"
            raw = (value or "").encode()
            for place in range(len(raw)):
                changed = raw[:place] + bytes([raw[place] ^ 1 << place % 8]) + raw[place + 1 :]
                attacker.execute(update, [changed, row])
                attacker.commit()
                unseen += [] if findings() != of_the_attack else [(column, place)]
            attacker.execute(f"UPDATE {table} SET {column} = ? WHERE rowid = ?", [value, row])
            attacker.commit()
    assert unseen == []
    assert findings() == []
