"""What one room's service consists of; routes get it by `Depends(parts_of)`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from starlette.requests import HTTPConnection

if TYPE_CHECKING:  # the parts know nothing of one another, and this module nothing of their insides
    from service.auth.proofs import Proofs
    from service.auth.sessions import SessionStore
    from service.cases.feed import EventFeed
    from service.database.engines import Database
    from service.images.arrivals import ImageArrivals
    from service.settings import Settings
    from service.vision_worker import VisionWorker


@dataclass(frozen=True, slots=True)
class Parts:
    """Every long-lived part, made once at start."""

    settings: Settings
    database: Database
    sessions: SessionStore
    proofs: Proofs
    feed: EventFeed
    arrivals: ImageArrivals
    vision: VisionWorker
    dicom_port: int


async def parts_of(connection: HTTPConnection) -> Parts:
    """The parts of the service that this request came to; async, so that it waits for no thread (H32)."""
    parts: Parts = connection.app.state.parts
    return parts
