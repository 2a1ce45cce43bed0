"""What is drawn over an image of a case, in the raw pixels that the tablet shows."""

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Depends
from sqlalchemy.engine import Connection

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.cases import store
from service.cases.records import ArtefactKind, StoredArtefact
from service.conductor.answers import OverlayAnswer
from service.conductor.image_work import accepted
from service.conductor.route_errors import OVERLAYS
from service.errors import ErrorCode, ServiceError
from service.images.store import original_bytes
from service.parts import Parts, parts_of

router = APIRouter(tags=["images of a case"])


@router.get(
    "/cases/{case_id}/images/{image_id}/overlay",
    openapi_extra=OVERLAYS,
    dependencies=[Depends(require(Permission.READ))],
)
async def read_overlay(case_id: str, image_id: str, parts: Annotated[Parts, Depends(parts_of)]) -> OverlayAnswer:
    """Wires, fiducials, balls, aim and targets of the newest registration of this image."""
    inputs = await asyncio.to_thread(_inputs, parts, case_id, image_id)
    return OverlayAnswer(**accepted(await parts.vision.run("overlay", *inputs)))


def _inputs(parts: Parts, case_id: str, image_id: str) -> tuple[bytes, dict[str, Any], list[dict[str, Any]]]:
    with parts.database.read() as connection:
        registration = _newest_registration(connection, case_id, image_id)
        targets = store.artefacts_of(connection, ArtefactKind.TARGET, case_id)
        return original_bytes(connection, image_id), dict(registration.content), [_point(one) for one in targets]


def _newest_registration(connection: Connection, case_id: str, image_id: str) -> StoredArtefact:
    """ServiceError IMAGE_NOT_REGISTERED where the case has none of this image."""
    found = store.artefacts_of(connection, ArtefactKind.REGISTRATION, case_id)
    of_image = [one for one in found if one.columns["image_id"] == image_id]
    if not of_image:
        raise ServiceError(ErrorCode.IMAGE_NOT_REGISTERED, "the case has no registration of this image")
    return of_image[-1]


def _point(target: StoredArtefact) -> dict[str, Any]:
    content = target.content
    return {"id": target.id, "image_id": content["image_id"]} | {
        key: content[key] for key in ("raw_px", "depth_mm", "planned_target")
    }
