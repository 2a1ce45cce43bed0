"""The web application of one room: parts made at start, routers mounted, errors typed."""

from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, AsyncExitStack, asynccontextmanager

from fastapi import APIRouter, FastAPI

from service.assembly import assemble
from service.parts import Parts
from service.problem_json import add_problem_handlers
from service.settings import Settings
from service.version import PRODUCT_VERSION

# Every feature's router, its paths below /api.
ROUTERS: tuple[APIRouter, ...] = ()
# What runs beside the requests: entered in this order once the parts are up, left in reverse before they close.
BACKGROUND: tuple[Callable[[FastAPI, Parts], AbstractAsyncContextManager[None]], ...] = ()


def create_app(settings: Settings) -> FastAPI:
    """The application; nothing is opened before its lifespan starts."""

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with AsyncExitStack() as stack:
            app.state.parts = await stack.enter_async_context(assemble(settings))
            for background in BACKGROUND:
                await stack.enter_async_context(background(app, app.state.parts))
            yield

    app = FastAPI(title="Coaxial", version=PRODUCT_VERSION, openapi_url="/api/openapi.json", lifespan=lifespan)
    add_problem_handlers(app)
    for router in ROUTERS:
        app.include_router(router, prefix="/api")
    return app
