"""One uvicorn process on the settings' address."""

import asyncio
import signal
import socket
from contextlib import suppress

import uvicorn
from fastapi import FastAPI

from robot.guard.pauses import spare_what_is_loaded, take_short_turns
from service.app import create_app
from service.connections import BACKLOG, PromptProtocol, allow_descriptors
from service.errors import ErrorCode, ServiceError
from service.parts import Parts
from service.settings import Settings


class _Server(uvicorn.Server):
    """Tells the address once the socket listens."""

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen, then print where: port 0 means that nobody knows before; ServiceError where that is taken."""
        try:
            await super().startup(sockets)
        except SystemExit as error:  # uvicorn's own end, its reason logged
            message = f"cannot listen for HTTP on {self.config.host}:{self.config.port}"
            raise ServiceError(ErrorCode.SETTINGS_REFUSED, message) from error
        if self.started:
            host, port = self.servers[0].sockets[0].getsockname()[:2]
            print(f"Coaxial listens on http://{f'[{host}]' if ':' in host else host}:{port}", flush=True)


def run(settings: Settings, claim_reason: str | None = None) -> None:
    """Serve until interrupted; ServiceError where a part refuses to start."""
    allow_descriptors()
    take_short_turns()
    asyncio.run(_serve(settings, claim_reason))


async def _serve(settings: Settings, claim_reason: str | None) -> None:
    app = create_app(settings, claim_reason)
    async with app.router.lifespan_context(app):
        # uvicorn raises the signal that ended it once more; the default action would skip the parts' own ending.
        for ending in (signal.SIGINT, signal.SIGTERM):
            signal.signal(ending, lambda *_: None)
        spare_what_is_loaded()
        starting = asyncio.create_task(_start_image_work(app.state.parts))
        await _Server(server_config(app, settings)).serve()
        starting.cancel()


async def _start_image_work(parts: Parts) -> None:
    """Ahead of the first image, beside everything else: nothing else waits for it, and the service goes on without it.

    A worker that does not start is told in the log and by its readiness; the first image tries again.
    """
    with suppress(ServiceError):
        await parts.vision.start()


def server_config(app: FastAPI, settings: Settings) -> uvicorn.Config:
    """How uvicorn is to serve `app`."""
    return uvicorn.Config(
        app,
        host=settings.http.host,
        port=settings.http.port,
        http=PromptProtocol,
        backlog=BACKLOG,
        lifespan="off",  # entered beside it, so that a refusal to start reaches the caller with its type
        log_config=None,
        access_log=False,
        # An open event stream would hold the service up for ever; stopping the arm never waits for this.
        timeout_graceful_shutdown=settings.http.shutdown_grace_s,
        ws_max_size=settings.http.max_body_bytes,
        server_header=False,
    )
