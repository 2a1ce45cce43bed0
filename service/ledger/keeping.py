"""What keeps the ledger while the service runs: hourly checkpoints, the anchor, checkpoints sent elsewhere."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

import structlog
from fastapi import FastAPI
from sqlalchemy.exc import SQLAlchemyError

from service.database.engines import Database
from service.errors import ServiceError
from service.ledger.anchor import advance_anchor
from service.ledger.checkpoints import sign_head
from service.ledger.entries import head_of
from service.ledger.keys import Signer
from service.ledger.syslog import CheckpointSender
from service.parts import Parts
from service.settings import Settings

_log = structlog.get_logger(__name__)
_HOUR_S = 3600.0
# The anchor follows the newest entry by at most about so much, and is written at most so often.
_STEP_S = 0.25
# A receiver that was down is tried again after so long, also where nothing is recorded.
_AGAIN_S = 30.0


@asynccontextmanager
async def keeping_ledger(_: FastAPI, parts: Parts) -> AsyncIterator[None]:
    """Keep the ledger; both ends of a run are signed."""
    database, signer = parts.database, parts.database.signer
    if signer is None:
        raise AssertionError("a service without a key would sign no checkpoint")
    await asyncio.to_thread(_sign, database, signer, "start")
    loop, changed = asyncio.get_running_loop(), asyncio.Event()

    def wake() -> None:
        loop.call_soon_threadsafe(changed.set)

    database.on_commit.append(wake)
    tasks = [
        asyncio.create_task(_sign_hourly(database, signer)),
        asyncio.create_task(_follow(parts.settings, database, signer, changed)),
    ]
    try:
        yield
    finally:
        database.on_commit.remove(wake)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await asyncio.to_thread(_sign, database, signer, "end")


async def _sign_hourly(database: Database, signer: Signer) -> None:
    while True:
        await asyncio.sleep(_HOUR_S)
        await asyncio.to_thread(_sign, database, signer, "hour")


async def _follow(settings: Settings, database: Database, signer: Signer, changed: asyncio.Event) -> None:
    sender = None
    if settings.audit.syslog_host is not None:
        sender = CheckpointSender(settings.audit, database, settings.data_folder / "audit" / "syslog-sent")
    while True:
        changed.clear()
        await asyncio.to_thread(_note, settings, database, signer, sender)
        await asyncio.sleep(_STEP_S)
        # not wait_for: in Python 3.11 it takes a cancellation for nothing where a commit comes with it, and the service
        # would not end
        with suppress(TimeoutError):
            async with asyncio.timeout(_AGAIN_S):
                await changed.wait()


def _note(settings: Settings, database: Database, signer: Signer, sender: CheckpointSender | None) -> None:
    try:
        advance_anchor(database, settings.anchor_file, signer)
        if sender is not None:
            sender.send_new()
    except (ServiceError, SQLAlchemyError, OSError, ValueError) as error:
        # The record goes on without its anchor: verification tells how far it lags.
        _log.error("ledger_not_noted", reason=str(error))


def _sign(database: Database, signer: Signer, reason: str) -> None:
    try:
        with database.write() as connection:
            sign_head(connection, head_of(connection), signer, reason)
    except ServiceError as error:
        _log.error("checkpoint_not_signed", reason=reason, code=error.code)
