"""Checkpoints: signed statements that the ledger up to an entry is what it is."""

import rfc8785
import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.database.clock import now_utc
from service.ledger.entries import Head
from service.ledger.keys import Signer

# Of the ledger's design: whoever rewrites the end of the ledger without the key can hide at most so many entries
# from a reader who has no anchor.
CHECKPOINT_EVERY = 1000


def sign_head(connection: Connection, head: Head, signer: Signer, reason: str) -> None:
    """Sign the newest entry; once, however many reasons there are."""
    table = tables.checkpoints
    last = connection.execute(sa.select(sa.func.max(table.c.sequence))).scalar() or 0
    if last == head.sequence:
        return
    statement = statement_on(head, signer, reason=reason, previous=last)
    values = {"sequence": head.sequence, "statement": statement, "signature": signer.sign(statement)}
    connection.execute(sa.insert(table).values(values))


def statement_on(head: Head, signer: Signer, **more: str | int) -> str:
    """What is signed: the entry's number and hash, when, and by which key."""
    return rfc8785.dumps(
        {
            "sequence": head.sequence,
            "sha256": head.sha256,
            "signed_at": now_utc(),
            "key": signer.verifier.name,
            **more,
        }
    ).decode()
