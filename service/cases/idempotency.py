"""Idempotency-Key: the first answer to a key is kept in the transaction of its effect and given again (H14)."""

import hashlib
import hmac
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.database.clock import now_utc
from service.errors import ErrorCode, ServiceError
from service.ledger.keys import Signer

_KEYS = tables.idempotency_keys
_KEPT = sa.select(_KEYS).where(_KEYS.c.user_id == sa.bindparam("user_id"), _KEYS.c.key == sa.bindparam("key"))


@dataclass(frozen=True, slots=True)
class Intent:
    """One request as a person meant it: who, their key, and what was asked."""

    user_id: str
    key: str
    request_mac: str


@dataclass(frozen=True, slots=True)
class KeptAnswer:
    """What was answered; `version` is the case's after the effect (its ETag)."""

    status: int
    body: dict[str, Any]
    version: int | None


def intent_of(signer: Signer, user_id: str, key: str, method: str, path: str, body: bytes) -> Intent:
    """The intent of a request; two requests are the same only to the byte.

    Bodies hold PINs: a plain hash, kept in the database, would tell the PIN to whoever reads a backup and tries ten
    thousand (H27). The secret of this one is outside the database.
    """
    request = b"\0".join((method.encode(), path.encode(), body))
    return Intent(user_id, key, hmac.digest(signer.secret("coaxial idempotency keys"), request, hashlib.sha256).hex())


def kept_answer(connection: Connection, intent: Intent) -> KeptAnswer | None:
    """The answer that the intent already had; ServiceError IDEMPOTENCY_KEY_REUSED if the key was for another request.

    To be called in the write transaction that will cause the effect: write transactions never overlap.
    """
    row = connection.execute(_KEPT, {"user_id": intent.user_id, "key": intent.key}).first()
    if row is None:
        return None
    if row.request_sha256 != intent.request_mac:
        raise ServiceError(ErrorCode.IDEMPOTENCY_KEY_REUSED, f"key {intent.key} was used for another request")
    return KeptAnswer(row.status, row.body, row.version)


def keep_answer(connection: Connection, intent: Intent, answer: KeptAnswer) -> None:
    """Keep the answer beside the effect, in the same transaction."""
    connection.execute(
        sa.insert(_KEYS).values(
            user_id=intent.user_id,
            key=intent.key,
            request_sha256=intent.request_mac,
            status=answer.status,
            body=answer.body,
            version=answer.version,
            created_at=now_utc(),
        )
    )
