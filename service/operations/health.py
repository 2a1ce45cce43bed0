"""Whether the service lives, and whether it could take a procedure now; told without a sign-in, and nothing else."""

import shutil
from typing import Annotated

import sqlalchemy as sa
from fastapi import APIRouter, Depends
from pydantic import BaseModel

from service.conductor.conductor import Conductor, TheConductor
from service.database.free_space import check_free_space
from service.errors import ErrorCode, ServiceError
from service.openapi import NO_SESSION, may_fail_with
from service.parts import Parts, parts_of
from service.settings import Settings
from service.version import PRODUCT_VERSION

router = APIRouter(prefix="/health", tags=["status"])
# The guard speaks at least 20 times a second; this is what its client takes for silence, too.
_GUARD_SILENT_S = 2.5


class Health(BaseModel):
    """Up."""

    status: str
    version: str


@router.get("/live", openapi_extra=NO_SESSION)
async def read_liveness() -> Health:
    """Whether the service answers: waits for no thread, no database and no arm."""
    return Health(status="up", version=PRODUCT_VERSION)


@router.get("/ready", openapi_extra=may_fail_with(ErrorCode.NOT_READY) | NO_SESSION)
def read_readiness(parts: Annotated[Parts, Depends(parts_of)], conductor: TheConductor) -> Health:
    """Whether database, disk, arm and image work would let a procedure go on; not_ready names each that would not."""
    reasons = [*_record(parts), *_arm(conductor), *_image_work(parts)]
    if reasons:
        raise ServiceError(ErrorCode.NOT_READY, f"not ready: {', '.join(reasons)}", measured=", ".join(reasons))
    return Health(status="ready", version=PRODUCT_VERSION)


def free_bytes(settings: Settings) -> int | None:
    """Free space on the data folder's disk; None where it cannot be told."""
    try:
        return shutil.disk_usage(settings.data_folder).free
    except OSError:
        return None


def _record(parts: Parts) -> list[str]:
    """Why nothing can be recorded: code by code."""
    reasons = []
    for look in (_ask_database, _check_disk):
        try:
            look(parts)
        except ServiceError as error:
            reasons.append(error.code)
        except OSError:
            reasons.append(ErrorCode.DISK_FULL.value)
    return reasons


def _ask_database(parts: Parts) -> None:
    with parts.database.read() as connection:
        connection.execute(sa.text("SELECT 1"))


def _check_disk(parts: Parts) -> None:
    check_free_space(parts.settings.data_folder, parts.settings.min_free_bytes)


def _arm(conductor: Conductor) -> list[str]:
    """Why the arm cannot be asked; a room without one is ready without it."""
    if conductor.parts.settings.arm_address is None:
        return []
    age_s, status = conductor.bridge.guard_age_s, conductor.bridge.status
    if age_s is None or age_s > _GUARD_SILENT_S:
        return ["guard_down"]
    return [] if status is not None and status.connected else ["arm_unreachable"]


def _image_work(parts: Parts) -> list[str]:
    """Why an image would have to wait: its worker starts, or did not when it was tried last."""
    return [] if parts.vision.why_down is None else [parts.vision.why_down]
