"""The case's events as they happen (server-sent events), from any point on by Last-Event-ID."""

import asyncio
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header
from fastapi.responses import StreamingResponse

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.cases import store
from service.cases.records import StoredEvent
from service.conductor.route_errors import READING
from service.database.json_text import to_text
from service.parts import Parts, parts_of

router = APIRouter(tags=["status"])
_READER = [Depends(require(Permission.READ))]


@router.get(
    "/cases/{case_id}/events",
    openapi_extra=READING,
    dependencies=[Depends(require(Permission.READ))],
    response_model=None,
)
async def follow_events(
    case_id: str,
    parts: Annotated[Parts, Depends(parts_of)],
    last_event_id: Annotated[int, Header(ge=0)] = 0,
) -> StreamingResponse:
    """Every event behind Last-Event-ID, then each new one; `id` is the sequence number, `event` the trigger."""
    await asyncio.to_thread(_check_known, parts, case_id)
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(_lines(parts, case_id, last_event_id), 200, headers, "text/event-stream")


async def _lines(parts: Parts, case_id: str, after: int) -> AsyncIterator[str]:
    async for event in parts.feed.follow(case_id, after):
        yield f"id: {event.sequence}\nevent: {event.trigger}\ndata: {to_text(_body(event))}\n\n"


def _body(event: StoredEvent) -> dict[str, Any]:
    return {
        "sequence": event.sequence,
        "version": event.version,
        "trigger": event.trigger,
        "user_id": event.user_id,
        "state": event.state,
        "recorded_at": event.recorded_at,
        "data": event.data,
    }


def _check_known(parts: Parts, case_id: str) -> None:
    with parts.database.read() as connection:
        store.read_case(connection, case_id)
