"""What the room has: the part of the status that belongs to no case."""

import shutil
from typing import Annotated

from fastapi import APIRouter, Depends
from pydantic import BaseModel

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.cases import store
from service.conductor.check_record import LastDailyCheck, last_check
from service.images.store import count_images
from service.parts import Parts, parts_of
from service.settings import ProcedureLimits
from service.version import PRODUCT_VERSION

router = APIRouter(tags=["status"])


class RoomStatus(BaseModel):
    """The room as the service sees it; the arm and the case have a status of their own at the case."""

    version: str
    room: str
    open_case: str | None
    images: int
    free_bytes: int
    min_free_bytes: int
    dicom_ae_title: str
    dicom_port: int
    arm_address: str | None
    settings_sha256: str
    daily_check: LastDailyCheck | None
    limits: ProcedureLimits


@router.get("/status")
def read_room_status(
    _: Annotated[Session, Depends(require(Permission.READ))], parts: Annotated[Parts, Depends(parts_of)]
) -> RoomStatus:
    """The room: its open case, images so far, disk, receiver, arm address and the age of the daily check."""
    settings = parts.settings
    with parts.database.read() as connection:
        open_case, images = store.open_case_of(connection, settings.room), count_images(connection)
        daily_check = last_check(connection)
    return RoomStatus(
        version=PRODUCT_VERSION,
        room=settings.room,
        open_case=open_case,
        images=images,
        free_bytes=shutil.disk_usage(settings.data_folder).free,
        min_free_bytes=settings.min_free_bytes,
        dicom_ae_title=settings.dicom.ae_title,
        dicom_port=parts.dicom_port,
        arm_address=settings.arm_address,
        settings_sha256=settings.fingerprint(),
        daily_check=daily_check,
        limits=settings.limits,
    )
