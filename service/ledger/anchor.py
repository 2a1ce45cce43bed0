"""The anchor: the newest entry's number and hash, signed, in a file outside the database (H26).

What was cut off the ledger's end, or an old copy of the database, is consistent in itself; only what is kept elsewhere
contradicts it. An anchor that the database contradicts is evidence: it is never written over.
"""

import json
from collections.abc import Mapping
from pathlib import Path

import sqlalchemy as sa
import structlog

from service.database import tables
from service.database.engines import Database
from service.ledger.checkpoints import statement_on
from service.ledger.entries import Head, head_of
from service.ledger.keys import Signer, Verifier
from service.whole_file import whole_file

_log = structlog.get_logger(__name__)


def read_anchor(file: Path, verifiers: Mapping[str, Verifier]) -> Head | None:
    """The anchored entry; None where there is no file. Raises ValueError where none of the keys has signed it."""
    try:
        kept = json.loads(file.read_bytes())
    except FileNotFoundError:
        return None
    statement = json.loads(kept["statement"])
    verifier = verifiers.get(statement["key"])
    if verifier is None or not verifier.confirms(kept["statement"], kept["signature"]):
        raise ValueError("it is not signed by a known key")
    return Head(statement["sequence"], statement["sha256"], "")


def advance_anchor(database: Database, file: Path, signer: Signer) -> None:
    """Note the newest entry, unless the database contradicts what is noted."""
    try:
        anchored = read_anchor(file, {signer.verifier.name: signer.verifier})
    except (OSError, ValueError, KeyError, TypeError) as error:
        _log.error("anchor_unusable", reason=str(error))
        return
    with database.read() as connection:
        head = head_of(connection)
        table = tables.ledger
        there = (
            anchored
            and connection.execute(sa.select(table.c.sha256).where(table.c.sequence == anchored.sequence)).scalar()
        )
    if anchored is not None and there != anchored.sha256:
        _log.error("anchor_contradicted", anchored=anchored.sequence, newest=head.sequence)
        return
    if anchored is None or anchored.sequence < head.sequence:
        _write(file, statement_on(head, signer), signer)


def _write(file: Path, statement: str, signer: Signer) -> None:
    """Replaced whole: a crash or a power cut leaves the older anchor, which the database still confirms."""
    text = json.dumps({"statement": statement, "signature": signer.sign(statement)})
    try:
        file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with whole_file(file) as part:
            part.write_text(text)
    except OSError as error:  # H24: another disk is full or away; the record goes on, the anchor follows later
        _log.error("anchor_not_written", reason=error.strerror)
