"""What sends while the service runs: cases that are over are made ready, then tried again until acknowledged."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress

import structlog
from fastapi import FastAPI

from service.errors import ServiceError
from service.pacs import outbox
from service.pacs.derived import DerivedObject
from service.pacs.peer import association_with
from service.pacs.preparing import objects_for
from service.pacs.sender import store
from service.parts import Parts

_log = structlog.get_logger(__name__)
# An archive that is down is tried again after so long; a case that ends is looked at as soon.
_AGAIN_S = 20.0


@asynccontextmanager
async def delivering(_: FastAPI, parts: Parts) -> AsyncIterator[None]:
    """Deliver until the end of the block; nothing to do for a service without an archive."""
    if parts.settings.pacs.host is None:
        yield
        return
    task = asyncio.create_task(_deliver(parts))
    try:
        yield
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


async def _deliver(parts: Parts) -> None:
    while True:
        with _told():
            for case_id in await asyncio.to_thread(_to_prepare, parts):
                with _told(case_id=case_id):
                    await _prepare(parts, case_id)
        with _told():
            await asyncio.to_thread(send_waiting, parts)
        await asyncio.sleep(_AGAIN_S)


@contextmanager
def _told(**about: str) -> Iterator[None]:
    """Log what went wrong, and go on: neither a defect met with one case nor a peer that is down ends the rest."""
    try:
        yield
    except ServiceError as error:
        _log.warning("delivery_waits", code=error.code, reason=error.message, **about)
    except Exception:  # noqa: BLE001  the next case has nothing to do with what this one met
        _log.exception("delivery_failed", **about)


async def _prepare(parts: Parts, case_id: str) -> None:
    objects = await objects_for(parts, case_id)
    if objects:
        await asyncio.to_thread(_queue, parts, case_id, objects)
        _log.info("objects_queued", case_id=case_id, count=len(objects))


def send_waiting(parts: Parts) -> None:
    """Send what waits, over one association; ServiceError PEER_UNREACHABLE where the archive is not there."""
    with parts.database.read() as connection:
        waiting = outbox.undelivered(connection)
    if not waiting:
        return
    settings = parts.settings
    with association_with(settings.pacs, settings.dicom.ae_title, [one.sop_class for one in waiting]) as association:
        for queued in waiting:
            with parts.database.read() as connection:
                content = outbox.content_of(connection, queued)
            stored = store(association, content)
            with parts.database.write() as connection:
                outbox.record_delivery(connection, queued, stored.words, accepted=stored.accepted)
            _log.info("object_sent", object_id=queued.id, accepted=stored.accepted, status=stored.status)


def _to_prepare(parts: Parts) -> list[str]:
    with parts.database.read() as connection:
        return outbox.cases_to_prepare(connection, parts.settings.room)


def _queue(parts: Parts, case_id: str, objects: list[DerivedObject]) -> None:
    with parts.database.write() as connection:
        outbox.queue(connection, case_id, objects)
