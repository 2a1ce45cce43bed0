"""Compares the ledger with what is anchored outside the database."""

from collections.abc import Mapping
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.ledger.anchor import read_anchor
from service.ledger.entries import Head
from service.ledger.findings import Finding, Verification
from service.ledger.keys import Verifier


def anchored_entry(file: Path, verifiers: Mapping[str, Verifier]) -> Head | Finding:
    """What the anchor says, or why it says nothing."""
    try:
        anchored = read_anchor(file, verifiers)
    except (OSError, ValueError, KeyError, TypeError) as error:
        return Finding("anchor", f"{file} cannot be relied on: {error}")
    if anchored is None:
        return Finding("anchor", f"{file} is not there: an end cut off or an older copy would not be seen")
    return anchored


def check_anchor(connection: Connection, verification: Verification, anchored: Head) -> None:
    """The anchored entry is in the ledger, so nothing was cut off behind it and the database is no older copy."""
    ledger = tables.ledger
    query = sa.select(ledger.c.sha256).where(ledger.c.sequence == anchored.sequence)
    sha256 = connection.execute(query).scalar()
    newest = connection.execute(sa.select(sa.func.max(ledger.c.sequence))).scalar() or 0
    if sha256 is None:
        what = f"entry {anchored.sequence} is anchored, the newest is {newest}: the end was cut off, or an older copy"
        verification.find("anchor", what)
    elif sha256 != anchored.sha256:
        verification.find("anchor", f"entry {anchored.sequence} is not the one that was anchored: written anew since")
