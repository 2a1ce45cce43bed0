"""What is drawn over an image of a case, in the raw pixels that the tablet shows."""

import asyncio
import sys
from typing import Annotated, Any

import sqlalchemy as sa
from fastapi import APIRouter, Depends
from sqlalchemy.engine import Connection

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.cases import store
from service.cases.records import ArtefactKind, StoredArtefact
from service.conductor.answers import OverlayAnswer
from service.conductor.handedness import NEW_VIEW
from service.conductor.image_work import accepted
from service.conductor.route_errors import OVERLAYS
from service.database import tables
from service.errors import ErrorCode, ServiceError
from service.images.store import original_bytes
from service.parts import Parts, parts_of
from workflow.triggers import Trigger

# A target picked before is another place of the image, or of the anatomy.
_PAST = (*NEW_VIEW, Trigger.PATIENT_MOVED)

router = APIRouter(tags=["images of a case"])


@router.get(
    "/cases/{case_id}/images/{image_id}/overlay",
    openapi_extra=OVERLAYS,
    dependencies=[Depends(require(Permission.READ))],
)
async def read_overlay(case_id: str, image_id: str, parts: Annotated[Parts, Depends(parts_of)]) -> OverlayAnswer:
    """What the newest registration of this image found, the targets of its view, and the aim at the newest of them."""
    inputs = await asyncio.to_thread(_inputs, parts, case_id, image_id)
    return OverlayAnswer(**accepted(await parts.vision.run("overlay", *inputs)))


def _inputs(parts: Parts, case_id: str, image_id: str) -> tuple[bytes, dict[str, Any], list[dict[str, Any]]]:
    with parts.database.read() as connection:
        registration = _newest_registration(connection, case_id, image_id)
        targets = targets_of_view(connection, case_id, registration.sequence)
        return original_bytes(connection, image_id), dict(registration.content), [_point(one) for one in targets]


def _newest_registration(connection: Connection, case_id: str, image_id: str) -> StoredArtefact:
    """ServiceError IMAGE_NOT_REGISTERED where the case has none of this image."""
    found = store.artefacts_of(connection, ArtefactKind.REGISTRATION, case_id)
    of_image = [one for one in found if one.columns["image_id"] == image_id]
    if not of_image:
        raise ServiceError(ErrorCode.IMAGE_NOT_REGISTERED, "the case has no registration of this image")
    return of_image[-1]


def targets_of_view(connection: Connection, case_id: str, sequence: int) -> list[StoredArtefact]:
    """Targets that were picked while C-arm and patient were as at this event, oldest first."""
    events = tables.events.c
    past = (events.case_id == case_id, events.trigger.in_(_PAST))
    begin = connection.execute(sa.select(sa.func.max(events.sequence)).where(*past, events.sequence < sequence))
    end = connection.execute(sa.select(sa.func.min(events.sequence)).where(*past, events.sequence > sequence))
    first, behind = begin.scalar() or 0, end.scalar() or sys.maxsize
    found = store.artefacts_of(connection, ArtefactKind.TARGET, case_id)
    return [one for one in found if first <= one.sequence < behind]


def _point(target: StoredArtefact) -> dict[str, Any]:
    content = target.content
    return {"id": target.id, "image_id": content["image_id"]} | {
        key: content[key] for key in ("raw_px", "depth_mm", "planned_target")
    }
