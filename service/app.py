"""The web application of one room: parts made at start, routers mounted, errors typed."""

from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, AsyncExitStack, asynccontextmanager

from fastapi import APIRouter, FastAPI

import service.archive.router
import service.auth.router
import service.cases.router
import service.devices.router
import service.images.router
import service.images.uploads
import service.ledger.router
import service.operations.health
import service.pacs.router
import service.report.router
import service.slicer.router
import service.trends.router
import service.web.router
from service import room_status
from service.assembly import assemble
from service.auth import people
from service.cases import artefacts
from service.conductor.background import conducting
from service.conductor.command_permissions import command_permissions
from service.conductor.routers import CONDUCTOR_ROUTERS
from service.edge import Edge
from service.images import pixels
from service.ledger.keeping import keeping_ledger
from service.openapi import described_by
from service.operations.metrics import measuring
from service.pacs.delivering import delivering
from service.parts import Parts
from service.problem_json import add_problem_handlers
from service.settings import Settings
from service.slicer.link import linking
from service.version import PRODUCT_VERSION

# Every feature's router, its paths below /api.
# Each is tried in turn: those of a case, which every screen asks all the time, come first.
ROUTERS: tuple[APIRouter, ...] = (
    *CONDUCTOR_ROUTERS,
    service.auth.router.router,
    room_status.router,
    service.operations.health.router,
    service.cases.router.router,
    service.devices.router.router,
    service.images.router.router,
    service.images.uploads.router,
    pixels.router,
    artefacts.router,
    people.router,
    service.ledger.router.router,
    service.pacs.router.router,
    service.archive.router.router,
    service.report.router.router,
    service.slicer.router.router,
    service.trends.router.router,
)
# What runs beside the requests: entered in this order once the parts are up, left in reverse before they close.
BACKGROUND: tuple[Callable[[FastAPI, Parts], AbstractAsyncContextManager[None]], ...] = (
    keeping_ledger,
    conducting,
    delivering,
    linking,
    measuring,
)

_DESCRIPTION = "Robot-assisted needle placement under C-arm fluoroscopy. Research software, not for clinical use."


def create_app(settings: Settings, claim_reason: str | None = None) -> FastAPI:
    """The application; nothing is opened before its lifespan starts.

    `claim_reason` is why the room is claimed from another workstation, where one left it.
    """

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with AsyncExitStack() as stack:
            app.state.parts = await stack.enter_async_context(assemble(settings, claim_reason))
            for background in BACKGROUND:
                await stack.enter_async_context(background(app, app.state.parts))
            yield

    app = FastAPI(
        title="Coaxial",
        version=PRODUCT_VERSION,
        description=_DESCRIPTION,
        openapi_url="/api/openapi.json",
        docs_url=None,  # its page loads scripts from elsewhere, which a room's network has not
        redoc_url=None,
        lifespan=lifespan,
    )
    app.openapi = described_by(app)  # type: ignore[method-assign]  # FastAPI's own way to extend the description
    larger = {"/api/images": settings.dicom.max_image_bytes}
    app.add_middleware(Edge, max_body_bytes=settings.http.max_body_bytes, larger=larger)
    add_problem_handlers(app)
    app.state.command_permissions = command_permissions(CONDUCTOR_ROUTERS)
    for router in ROUTERS:
        app.include_router(router, prefix="/api")
    app.include_router(service.operations.health.router, include_in_schema=False)  # where orchestrators look for it
    app.include_router(service.web.router.router)
    return app
