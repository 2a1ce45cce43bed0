"""The headers of a command: If-Match (the version decided on) and Idempotency-Key (one intent, one effect)."""

from typing import Annotated

from fastapi import Depends, Header, Request

from service.auth.dependencies import current_session
from service.auth.session import Session
from service.cases.idempotency import Intent, intent_of
from service.errors import ErrorCode, ServiceError
from service.parts import Parts, parts_of

_LONGEST_KEY = 128


def etag(version: int) -> str:
    """A case's version as an entity tag."""
    return f'"{version}"'


async def expected_version(if_match: Annotated[str | None, Header()] = None) -> int:
    """The version in If-Match; ServiceError VERSION_MISSING without one that is a number."""
    digits = (if_match or "").strip().strip('"')
    if not (digits.isascii() and digits.isdigit() and len(digits) <= 15):
        raise ServiceError(ErrorCode.VERSION_MISSING, 'If-Match must be the version that was read, as in "7"')
    return int(digits)


async def intent(
    request: Request,
    session: Annotated[Session, Depends(current_session)],
    parts: Annotated[Parts, Depends(parts_of)],
    idempotency_key: Annotated[str | None, Header()] = None,
) -> Intent:
    """The request as an intent; ServiceError IDEMPOTENCY_KEY_MISSING."""
    if not idempotency_key or len(idempotency_key) > _LONGEST_KEY:
        raise ServiceError(ErrorCode.IDEMPOTENCY_KEY_MISSING, "1 to 128 characters, new for every intent")
    return await meant_by(request, session, parts, idempotency_key)


async def meant_by(request: Request, session: Session, parts: Parts, key: str) -> Intent:
    """What a person means by this request under this key."""
    signer = parts.database.signer
    if signer is None:
        raise AssertionError("a service without a key would keep PINs as good as plain")
    return intent_of(signer, session.user_id, key, request.method, request.url.path, await request.body())
