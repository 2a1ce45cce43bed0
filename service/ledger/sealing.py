"""The end of a write transaction: one entry over all the rows that it added, signed where a checkpoint is due."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.engine import Connection

from service.errors import ErrorCode, ServiceError
from service.ledger.checkpoints import CHECKPOINT_EVERY, sign_head
from service.ledger.draft import Draft, begin_draft
from service.ledger.entries import append_entry, head_of
from service.ledger.keys import Signer


@contextmanager
def sealed(connection: Connection, signer: Signer | None) -> Iterator[None]:
    """Gather what the block records and seal it; a block that adds no record row leaves no entry."""
    draft = begin_draft(connection)
    yield
    if draft.covered:
        seal(connection, draft, signer)


def seal(connection: Connection, draft: Draft, signer: Signer | None) -> None:
    """Write the draft's entry behind the newest.

    ServiceError LEDGER_BROKEN where there is none, KEY_MISSING where it must be signed and there is no key.
    """
    head = append_entry(connection, draft, head_of(connection))
    reason = draft.checkpoint or ("count" if head.sequence % CHECKPOINT_EVERY == 0 else None)
    if signer is not None and reason is not None:
        sign_head(connection, head, signer, reason)
    elif reason == "count":
        raise ServiceError(ErrorCode.KEY_MISSING, "the next entry is one that is always signed", measured=head.sequence)
