"""Makes the parts of one room's service at start, and takes them down in reverse."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial

from service.auth.proofs import Proofs
from service.auth.sessions import SessionStore
from service.auth.users import UserStore
from service.cases.feed import EventFeed
from service.database.current import current_database
from service.database.free_space import check_free_space
from service.database.room_claim import room_claim
from service.images.arrivals import ImageArrivals
from service.images.receiver import DicomReceiver
from service.parts import Parts
from service.settings import Settings
from service.vision_worker import VisionWorker


@asynccontextmanager
async def assemble(settings: Settings, claim_reason: str | None = None) -> AsyncIterator[Parts]:
    """Every part of the service, up; ServiceError where disk, database, schema or the room claim refuse."""
    with current_database(settings) as database, room_claim(database, settings.room, claim_reason):
        database.expect_answers()
        arrivals = ImageArrivals()
        users, sessions = UserStore(database), SessionStore(database, settings.session)
        vision = VisionWorker(settings.vision)
        check_room = partial(check_free_space, settings.data_folder, settings.min_free_bytes)
        with DicomReceiver(settings.dicom, database, arrivals, check_room).listening() as dicom_port:
            try:
                yield Parts(
                    settings=settings,
                    database=database,
                    sessions=sessions,
                    proofs=Proofs(database, users, settings.session),
                    feed=EventFeed(database),
                    arrivals=arrivals,
                    vision=vision,
                    dicom_port=dicom_port,
                )
            finally:
                await vision.close()
                await asyncio.to_thread(sessions.close)
