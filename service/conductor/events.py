"""The case's events as they happen (server-sent events), from any point on by Last-Event-ID."""

import asyncio
import random
import time
from collections.abc import AsyncIterator
from contextlib import aclosing
from typing import Annotated

from fastapi import APIRouter, Depends, Header
from fastapi.responses import StreamingResponse
from starlette.requests import Request

from service.auth.dependencies import bearer_or_cookie, require
from service.auth.permissions import Permission, allows
from service.auth.session import SessionStatus
from service.cases import store
from service.cases.server_sent import KEEP_ALIVE
from service.conductor.route_errors import READING
from service.database.tables import LARGEST_SEQUENCE
from service.openapi import answers_with
from service.parts import Parts, parts_of

router = APIRouter(tags=["status"])

# A stream on which nothing happens says so this often; who hears nothing for longer has lost the service.
_KEEP_ALIVE_S = 5.0
# A session that was revoked elsewhere, and a user who was disabled, are noticed within it.
_CHECK_S = 10.0


@router.get(
    "/cases/{case_id}/events",
    response_class=StreamingResponse,
    responses=answers_with("text/event-stream"),
    openapi_extra=READING,
    dependencies=[Depends(require(Permission.READ))],
    response_model=None,
)
async def follow_events(
    request: Request,
    case_id: str,
    parts: Annotated[Parts, Depends(parts_of)],
    last_event_id: Annotated[int, Header(ge=0, le=LARGEST_SEQUENCE)] = 0,
) -> StreamingResponse:
    """Every event behind Last-Event-ID, then each new one; `id` is the sequence number, `event` the trigger.

    A comment comes every 5 s while nothing happens. The stream ends with the session.
    """
    await asyncio.to_thread(_check_known, parts, case_id)
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    token = bearer_or_cookie(request) or ""
    return StreamingResponse(_told(parts, case_id, last_event_id, token), 200, headers, "text/event-stream")


async def _told(parts: Parts, case_id: str, after: int, token: str) -> AsyncIterator[bytes]:
    check_at_s = _next_check_s()
    async with aclosing(parts.feed.follow(case_id, after, _KEEP_ALIVE_S)) as followed:
        async for events in followed:
            # a sign-out here is known without the database, and at once
            if time.monotonic() >= check_at_s or parts.sessions.remembered(token) is None:
                if not await asyncio.to_thread(_may_read, parts, token):
                    return
                check_at_s = _next_check_s()
            yield b"".join(event.text for event in events) or KEEP_ALIVE


def _next_check_s() -> float:
    """Not when others look: fifty screens that came together would all ask the database at the same event."""
    return time.monotonic() + random.uniform(0.5, 1.0) * _CHECK_S


def _may_read(parts: Parts, token: str) -> bool:
    session = parts.sessions.look(token)
    if session is None or session.status is SessionStatus.EXPIRED:
        return False
    return allows(session.role, Permission.READ)


def _check_known(parts: Parts, case_id: str) -> None:
    with parts.database.read() as connection:
        store.read_case(connection, case_id)
