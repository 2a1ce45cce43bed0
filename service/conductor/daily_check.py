"""The daily check of a room: the arm, its devices, and one image of the guide held against the arm."""

import asyncio
from dataclasses import asdict
from typing import Annotated

from fastapi import APIRouter, Depends
from pydantic import BaseModel
from sqlalchemy.engine import Connection

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.cases import store
from service.conductor.begun_checks import BegunCheck
from service.conductor.bodies import ImageAgain, Nothing
from service.conductor.check_items import CheckItem, arm_items, device_items, image_items, newest_tool, still_items
from service.conductor.check_record import record_check
from service.conductor.conductor import Conductor, TheConductor, new_id
from service.devices.store import DeviceKind, device_bytes, newest_device
from service.errors import ErrorCode, ServiceError
from service.images.store import StoredImage, count_images, original_bytes, read_image
from service.openapi import may_fail_with

router = APIRouter(tags=["status"])
Engineer = Annotated[Session, Depends(require(Permission.CALIBRATE))]
_WAIT_S = 0.3
_READ_WITH = (DeviceKind.GUIDE, DeviceKind.CARM)


class CheckItemAnswer(BaseModel):
    """One thing that was looked at."""

    code: str
    passed: bool
    measured: float | str | bool | None
    limit: float | str | bool | None
    unit: str
    what_to_do: str


class DailyCheckAnswer(BaseModel):
    """How far the check is; `passed` is null while it waits for its image."""

    check_id: str
    passed: bool | None
    images_before: int
    items: list[CheckItemAnswer]


@router.post("/daily-check", openapi_extra=may_fail_with(ErrorCode.CASE_OPEN, ErrorCode.DEVICE_UNKNOWN))
def begin_daily_check(_: Nothing, session: Engineer, conductor: TheConductor) -> DailyCheckAnswer:
    """Look at arm and devices, and latch the arm's pose: then one image of the guide. What fails here is the result."""
    watch, limits, check_id = conductor.bridge.watch, conductor.rules.limits, new_id()
    reading = watch.reading(_WAIT_S)
    with conductor.parts.database.read() as connection:
        _refuse_open_case(connection, conductor)
        items = (*arm_items(reading, newest_tool(connection), limits), *device_items(connection))
        check = BegunCheck(check_id, session.user_id, count_images(connection), items)
    if not all(one.passed for one in items):
        return _record(conductor, check, items, None)
    watch.open_exposure(check_id)
    conductor.daily_checks.remember(check)
    return _answer(check, items, None)


@router.post(
    "/daily-check/{check_id}/image", openapi_extra=may_fail_with(ErrorCode.CHECK_UNKNOWN, ErrorCode.IMAGE_UNKNOWN)
)
async def finish_daily_check(check_id: str, body: ImageAgain, _: Engineer, conductor: TheConductor) -> DailyCheckAnswer:
    """Register the image of the guide that was taken meanwhile, compare it with the arm, record the result."""
    image, files = await asyncio.to_thread(_image, conductor, body.image_id)
    check = conductor.daily_checks.take(check_id)
    if check is None or image.position <= check.images_before:
        raise ServiceError(ErrorCode.CHECK_UNKNOWN, "no check waits for this image")
    # Of a guide without a bead no single image proves the handedness: that is the nudge's, not this check's.
    result = await conductor.parts.vision.register(*files, handedness_proved=True)
    exposure = conductor.bridge.watch.exposure_of_window(check_id)
    still = still_items(exposure, conductor.rules.limits)
    items = (*check.items, *still, *image_items(result, image, exposure))
    return await asyncio.to_thread(_record, conductor, check, items, image.id)


def _refuse_open_case(connection: Connection, conductor: Conductor) -> None:
    open_id = store.open_case_of(connection, conductor.parts.settings.room)
    if open_id is not None:
        raise ServiceError(ErrorCode.CASE_OPEN, f"the room has the open case {open_id}")


def _image(conductor: Conductor, image_id: str) -> tuple[StoredImage, tuple[bytes, bytes, bytes]]:
    """The image, with its bytes and those of guide and C-arm file."""
    with conductor.parts.database.read() as connection:
        guide, carm = (device_bytes(connection, newest_device(connection, kind).id) for kind in _READ_WITH)
        return read_image(connection, image_id), (original_bytes(connection, image_id), guide, carm)


def _record(
    conductor: Conductor, check: BegunCheck, items: tuple[CheckItem, ...], image_id: str | None
) -> DailyCheckAnswer:
    passed = all(one.passed for one in items)
    with conductor.parts.database.write() as connection:
        record_check(connection, check.user_id, items, passed, image_id)
    return _answer(check, items, passed)


def _answer(check: BegunCheck, items: tuple[CheckItem, ...], passed: bool | None) -> DailyCheckAnswer:
    answers = [CheckItemAnswer(**asdict(one)) for one in items]
    return DailyCheckAnswer(check_id=check.id, passed=passed, images_before=check.images_before, items=answers)
