"""Makes the parts of one room's service at start, and takes them down in reverse."""

from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager

from service.auth.proofs import Proofs
from service.auth.sessions import SessionStore
from service.auth.users import UserStore
from service.cases.feed import EventFeed
from service.database.engines import Database, open_database
from service.database.free_space import check_free_space
from service.database.migrate import migrate
from service.database.room_claim import room_claim
from service.images.arrivals import ImageArrivals
from service.images.receiver import DicomReceiver
from service.parts import Parts
from service.settings import Settings
from service.vision_worker import VisionWorker


@contextmanager
def current_database(settings: Settings) -> Iterator[Database]:
    """The database with the newest schema, for a command or the service; ServiceError where disk or schema refuse."""
    settings.data_folder.mkdir(parents=True, exist_ok=True)
    check_free_space(settings.data_folder, settings.min_free_bytes)
    database = open_database(settings.database_url)
    try:
        migrate(database)
        yield database
    finally:
        database.close()


@asynccontextmanager
async def assemble(settings: Settings) -> AsyncIterator[Parts]:
    """Every part of the service, up; ServiceError where disk, database, schema or the room claim refuse."""
    with current_database(settings) as database, room_claim(database, settings.room):
        arrivals = ImageArrivals()
        users = UserStore(database)
        vision = VisionWorker(settings.vision)
        with DicomReceiver(settings.dicom, database, arrivals).listening() as dicom_port:
            try:
                yield Parts(
                    settings=settings,
                    database=database,
                    users=users,
                    sessions=SessionStore(database, settings.session),
                    proofs=Proofs(database, users, settings.session),
                    feed=EventFeed(database),
                    arrivals=arrivals,
                    vision=vision,
                    dicom_port=dicom_port,
                )
            finally:
                await vision.close()
