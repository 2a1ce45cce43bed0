"""Checks an archive by itself: signature, hashes, chain, and every row against the entry that vouches for it."""

import hashlib
import json
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from service.archive.container import KEY, MANIFEST, SIGNATURE, SIGNED_APART, Archive, open_archive
from service.archive.contents import ARCHIVED, Row
from service.ledger.entries import sha256_of
from service.ledger.findings import Verification
from service.ledger.keys import Verifier, public_key_in
from service.ledger.rows import Key, digest, key_of
from service.ledger.rows_check import shown, vouched_for


def check_file(path: Path, trusted: Mapping[str, Verifier]) -> Verification:
    """What is wrong with an archive; without `trusted` keys the one inside is believed.

    ServiceError ARCHIVE_REFUSED where the file is no archive.
    """
    with open_archive(path) as archive:
        return check_archive(archive, trusted)


def check_archive(archive: Archive, trusted: Mapping[str, Verifier]) -> Verification:
    """The same, of an archive that is open."""
    verification = Verification()
    verifiers = trusted or _own_key(archive, verification)
    _check_signature(archive, verifiers, verification)
    _check_members(archive, verification)
    if archive.manifest.get("pseudonymised") is None:
        entries = list(_entries(archive, verification))
        _check_runs(archive, entries, verifiers, verification)
        _check_rows(archive, [entry for _, entry in entries], verification)
    _check_events(archive, verification)
    return verification


def _own_key(archive: Archive, verification: Verification) -> Mapping[str, Verifier]:
    try:
        verifier = public_key_in(archive.read(KEY))
    except ValueError:
        verification.find(KEY, "is no public key: changed")
        return {}
    return {verifier.name: verifier}


def _check_signature(archive: Archive, verifiers: Mapping[str, Verifier], verification: Verification) -> None:
    verifier = verifiers.get(str(archive.manifest.get("key")))
    signature = archive.read(SIGNATURE).decode(errors="replace")
    if verifier is None:
        verification.find(MANIFEST, "signed by an unknown key, or changed")
    elif not verifier.confirms(archive.read(MANIFEST).decode(errors="replace"), signature):
        verification.find(MANIFEST, "the signature does not belong to it: changed, or signed without the key")


def _check_members(archive: Archive, verification: Verification) -> None:
    listed = archive.manifest["members"]
    there = [name for name in archive.names if name not in SIGNED_APART]
    for name in sorted({name for name in there if there.count(name) > 1} | (set(there) - set(listed))):
        verification.find(name, "not in the manifest, or twice in the file: added")
    for name in sorted(listed):
        if name not in there:
            verification.find(name, "in the manifest and not in the file: removed")
        elif hashlib.sha256(archive.read(name)).hexdigest() != listed[name]:
            verification.find(name, "has not its hash: changed")
        elif name.startswith("files/") and not name.startswith(f"files/{listed[name]}"):
            verification.find(name, "is not named by its hash: changed")


def _entries(archive: Archive, verification: Verification) -> Iterator[tuple[Row, dict[str, Any]]]:
    for row in archive.objects("ledger/entries.jsonl"):
        where, text = f"entry {row.get('sequence')}", str(row.get("entry"))
        if sha256_of(text) != row.get("sha256"):
            verification.find(where, "its text has not its hash: changed")
        try:
            entry = json.loads(text)
            if entry["sequence"] != row["sequence"] or not isinstance(entry["rows"], dict):
                raise ValueError
        except (ValueError, KeyError, TypeError, RecursionError):
            verification.find(where, "its text is no such entry: changed")
            continue
        verification.entries += 1
        yield row, entry


def _check_runs(
    archive: Archive,
    entries: list[tuple[Row, dict[str, Any]]],
    verifiers: Mapping[str, Verifier],
    verification: Verification,
) -> None:
    """Entries follow one another without a gap, up to a signature; only behind one may a new run begin."""
    signed = _signed(archive, verifiers, verification)
    before: Row | None = None
    for row, entry in entries:
        where = f"entry {row['sequence']}"
        if before is not None and before["sequence"] not in signed:
            if row["sequence"] != before["sequence"] + 1:
                verification.find(where, f"entry {before['sequence'] + 1} should stand before it: missing")
            elif entry.get("previous") != before["sha256"]:
                verification.find(where, "does not follow the entry before it: one of the two is not what was written")
        if row["sequence"] in signed and signed[row["sequence"]] != row["sha256"]:
            verification.find(where, "not what was signed: written anew since")
        before = row
    if before is not None and before["sequence"] not in signed:
        verification.find(f"entry {before['sequence']}", "no signature behind it: the end was cut off")


def _signed(archive: Archive, verifiers: Mapping[str, Verifier], verification: Verification) -> dict[int, str]:
    """Hashes of signed entries by their number."""
    signed: dict[int, str] = {}
    for row in archive.objects("ledger/checkpoints.jsonl"):
        where, text = f"checkpoint {row.get('sequence')}", str(row.get("statement"))
        try:
            statement = json.loads(text)
            verifier = verifiers.get(statement["key"])
            if verifier is None or not verifier.confirms(text, str(row.get("signature"))):
                verification.find(where, "signed by an unknown key, or the signature does not belong to it: changed")
                continue
            signed[statement["sequence"]] = statement["sha256"]
        except (ValueError, KeyError, TypeError, RecursionError):
            verification.find(where, "is no statement: changed")
            continue
        verification.checkpoints += 1
    return signed


def _check_rows(archive: Archive, entries: list[dict[str, Any]], verification: Verification) -> None:
    """Each row is what an entry vouches for; and of the case's own entries each row is there."""
    case_id = archive.manifest.get("case_id")
    vouched = {(name, key): (sha256, sequence) for name, key, sha256, sequence in vouched_for(entries)}
    of_case = [entry for entry in entries if entry.get("case_id") == case_id]
    expected = {(name, key): sequence for name, key, _, sequence in vouched_for(of_case)}
    for table in ARCHIVED:
        groups: dict[Key, list[tuple[Any, ...]]] = defaultdict(list)
        for row in archive.objects(f"rows/{table.name}.jsonl"):
            values = tuple(row.get(column.name) for column in table.columns)
            groups[key_of(table, values)].append(values)
        for key, rows in groups.items():
            where = f"{table.name} {shown(key)}"
            sha256, sequence = vouched.get((table.name, key), (None, None))
            if sha256 is None:
                verification.find(where, "no entry vouches for it: inserted")
            elif digest(table, rows) != sha256:
                verification.find(where, f"not what entry {sequence} vouches for: changed")
            verification.vouched[table.name] += len(rows)
        for name, key in expected:
            if name == table.name and key not in groups:
                verification.find(f"{name} {shown(key)}", f"missing: entry {expected[name, key]} vouches for it")


def _check_events(archive: Archive, verification: Verification) -> None:
    sequences = [row.get("sequence") for row in archive.objects("rows/events.jsonl")]
    if sequences != list(range(1, len(sequences) + 1)) or len(sequences) != archive.manifest.get("events"):
        verification.find("events", "their numbers are not one after another: missing, or inserted")
