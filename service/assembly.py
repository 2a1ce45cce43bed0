"""Makes the parts of one room's service at start, and takes them down in reverse."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from service.auth.sessions import SessionStore
from service.auth.users import UserStore
from service.cases.feed import EventFeed
from service.database.engines import open_database
from service.images.arrivals import ImageArrivals
from service.parts import Parts
from service.settings import Settings
from service.vision_worker import VisionWorker


@asynccontextmanager
async def assemble(settings: Settings) -> AsyncIterator[Parts]:
    """Every part of the service, up; ServiceError where the disk, the database or the room claim refuses."""
    settings.data_folder.mkdir(parents=True, exist_ok=True)
    database = open_database(settings.database_url)
    try:
        yield Parts(
            settings=settings,
            database=database,
            users=UserStore(database),
            sessions=SessionStore(database, settings.session),
            feed=EventFeed(database),
            arrivals=ImageArrivals(),
            vision=VisionWorker(settings.vision),
        )
    finally:
        database.close()
