"""Compares the ledger with what was signed."""

import json
from collections.abc import Iterable, Mapping
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.ledger.checkpoints import CHECKPOINT_EVERY
from service.ledger.findings import Verification
from service.ledger.keys import Verifier

_NO_STATEMENT: Mapping[str, Any] = {}


def check_checkpoints(
    connection: Connection, verification: Verification, verifiers: Mapping[str, Verifier], due: Iterable[int]
) -> None:
    """Every checkpoint is signed by a known key and says what the ledger says; those that are `due` are there."""
    checkpoints, ledger = tables.checkpoints, tables.ledger
    joined = checkpoints.outerjoin(ledger, ledger.c.sequence == checkpoints.c.sequence)
    query = sa.select(checkpoints, ledger.c.sha256).select_from(joined).order_by(checkpoints.c.sequence)
    last, there = 0, set()
    for sequence, text, signature, sha256 in connection.execute(query):
        statement = _statement(text)
        verifier, where = verifiers.get(statement.get("key", "")), f"checkpoint {sequence}"
        if verifier is None:
            verification.find(where, "signed by an unknown key, or changed")
        elif not verifier.confirms(text, signature):
            verification.find(
                where, "the signature does not belong to the statement: changed, or signed without the key"
            )
        elif statement["sequence"] != sequence:
            verification.find(where, f"is the checkpoint of entry {statement['sequence']}: moved")
        elif statement["previous"] != last:
            verification.find(where, f"checkpoint {statement['previous']} stood before it, not {last}: one is missing")
        elif sha256 != statement["sha256"]:
            verification.find(
                f"entries {last + 1} to {sequence}", "not what was signed: missing, or written anew since"
            )
        last = sequence
        there.add(sequence)
    for sequence in sorted(set(due) - there):
        verification.find(f"checkpoint {sequence}", "missing: such an entry is always signed")
    verification.checkpoints = len(there)


def due_by_count(newest: int) -> range:
    """Entries that are signed whatever they say."""
    return range(CHECKPOINT_EVERY, newest + 1, CHECKPOINT_EVERY)


def _statement(text: Any) -> Mapping[str, Any]:
    try:
        statement = json.loads(text)
    except (ValueError, TypeError, RecursionError):
        return _NO_STATEMENT
    return statement if isinstance(statement, dict) else _NO_STATEMENT
