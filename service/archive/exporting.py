"""Exports a case: its rows, the bytes that they name, the proof of both, signed as a whole."""

import hashlib
from pathlib import Path
from typing import Any

from service.archive.container import manifest_of, write_archive
from service.archive.contents import Contents, contents_of, line
from service.archive.proof import Proof, proof_of
from service.archive.pseudonyms import pseudonymise
from service.audit import record_audit
from service.cases import store
from service.database.engines import Database
from service.ledger.draft import describe
from service.ledger.keys import Signer
from service.version import PRODUCT_VERSION

FORMAT = 1
EXPORTED = "case_exported"
_SUFFIXES = {b"\x89PNG": ".png", b"II*\x00": ".tif", b"MM\x00*": ".tif", b"\x1f\x8b": ".gz", b'{"': ".json"}
_README = b"""A case of Coaxial as it was recorded.

manifest.json    what this is, and the SHA-256 of every member; signed in manifest.sig (Ed25519) by public-key.pem
rows/            the record, a row a line; JSON within a row is the text that was stored, to the letter
files/           images, device files, settings and trajectories to the byte, by their SHA-256
ledger/          the entries that vouch for every row, each with the hash of the one before, and signed checkpoints
users.json       who the ids of people stand for

`coaxial case verify FILE` checks all of it and needs no database. A pseudonymised archive has no ledger: its rows are
not those that were recorded, and only manifest.sig says where it comes from.
"""


# Said by the archive itself, so that nobody takes it for the record.
_HONESTLY = (
    "Pseudonymised: these are not the rows that were recorded, and no hash or signature of the ledger fits them."
)


def export_case(
    database: Database, signer: Signer, case_id: str, user_id: str | None, out: Path, *, pseudonymised: bool
) -> None:
    """Write a case to a file; ServiceError CASE_UNKNOWN, ARCHIVE_REFUSED.

    That it is exported is recorded first, and signed, so that nothing in the file waits for a signature.
    """
    with database.write() as connection:
        store.read_case(connection, case_id)
        record_audit(connection, EXPORTED, user_id, {"case": case_id, "pseudonymised": pseudonymised})
        describe(connection, checkpoint=EXPORTED)
    with database.read() as connection:
        contents = contents_of(connection, case_id)
        proof = proof_of(connection, case_id, contents.rows)
    members, about = _members(contents) | _proof_members(proof), _about(case_id, contents)
    manifest = manifest_of(members, about, signer)
    if pseudonymised:
        # The hospital makes the same original again and sees from its hash which case the maker speaks of.
        about |= {"pseudonymised": _HONESTLY, "original_manifest_sha256": hashlib.sha256(manifest).hexdigest()}
        members = _members(pseudonymise(contents, signer))
        manifest = manifest_of(members, about, signer)
    write_archive(out, members, manifest, signer)


def _about(case_id: str, contents: Contents) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "written_by": f"coaxial {PRODUCT_VERSION}",
        "case_id": case_id,
        "events": len(contents.rows["events"]),
        "pseudonymised": None,
    }


def _members(contents: Contents) -> dict[str, bytes]:
    rows = {f"rows/{name}.jsonl": b"".join(map(line, some)) for name, some in contents.rows.items()}
    files = {f"files/{sha256}{_suffix(content)}": content for sha256, content in contents.files.items()}
    return {"README.txt": _README, "users.json": line(contents.users), **rows, **files}


def _proof_members(proof: Proof) -> dict[str, bytes]:
    return {
        "ledger/entries.jsonl": b"".join(map(line, proof.entries)),
        "ledger/checkpoints.jsonl": b"".join(map(line, proof.checkpoints)),
    }


def _suffix(content: bytes) -> str:
    if content[128:132] == b"DICM":
        return ".dcm"
    return next((suffix for magic, suffix in _SUFFIXES.items() if content.startswith(magic)), ".txt")
