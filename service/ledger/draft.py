"""What a transaction has recorded so far: gathered while it runs, sealed into one entry when it ends."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

_KEY = "ledger_draft"


@dataclass(slots=True)
class Draft:
    """The rows that an entry will vouch for, and what it will say of them."""

    covered: dict[sa.Table, dict[tuple[Any, ...], list[tuple[Any, ...]]]] = field(default_factory=dict)
    action: str | None = None
    actor: str | None = None
    case_id: str | None = None
    before: str | None = None
    after: str | None = None
    attempt_id: int | None = None
    artefacts: list[str] = field(default_factory=list)
    payload: dict[str, Any] = field(default_factory=dict)
    checkpoint: str | None = None  # the reason to sign this entry, where there is one

    def cover(self, table: sa.Table, key: tuple[Any, ...], row: tuple[Any, ...]) -> None:
        """Vouch for one more row."""
        self.covered.setdefault(table, {}).setdefault(key, []).append(row)


def begin_draft(connection: Connection) -> Draft:
    """A fresh draft for a transaction that begins."""
    draft = connection.info[_KEY] = Draft()
    return draft


def draft_of(connection: Connection) -> Draft:
    """The draft of the transaction that runs."""
    draft: Draft = connection.info[_KEY]
    return draft


def describe(connection: Connection, *, payload: Mapping[str, Any] | None = None, **said: Any) -> None:
    """Say what the transaction does, by the names of the draft; the last word counts."""
    draft = draft_of(connection)
    for name, value in said.items():
        if value is not None:
            setattr(draft, name, value)
    draft.payload |= payload or {}
