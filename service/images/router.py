"""Images: list, metadata, original bytes, and what was found in those that were refused."""

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Response
from pydantic import BaseModel
from sqlalchemy.engine import Connection

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.errors import ErrorCode
from service.images import store
from service.images.findings import findings_of
from service.images.store import StoredImage
from service.openapi import answers_with, may_fail_with
from service.parts import Parts, parts_of
from workflow.decisions import ImageUse

router = APIRouter(tags=["images"])
Reader = Annotated[Session, Depends(require(Permission.READ))]
PartsOfRoom = Annotated[Parts, Depends(parts_of)]


class ImageView(BaseModel):
    """An image without its bytes; `purpose` is null while nobody has decided, `refused_by` says why it is no other."""

    id: str
    position: int
    sha256: str
    sop_uid: str | None
    pixel_sha256: str | None
    duplicate_of: str | None
    patient_id: str | None
    study_uid: str | None
    problem: dict[str, Any] | None
    source: dict[str, Any]
    metadata: dict[str, Any]
    received_at: str
    purpose: str | None
    case_id: str | None
    refused_by: list[dict[str, Any]]


@router.get("/images")
def list_newest_images(
    _: Reader,
    parts: PartsOfRoom,
    case_id: Annotated[str | None, Query(alias="case")] = None,
    purpose: ImageUse | None = None,
) -> list[ImageView]:
    """The newest images, of one case or purpose (`quarantined`) if named, newest first."""
    with parts.database.read() as connection:
        return [_view(connection, image) for image in store.list_images(connection, case_id, purpose=purpose)]


@router.get("/images/{image_id}", openapi_extra=may_fail_with(ErrorCode.IMAGE_UNKNOWN))
def read_one_image(image_id: str, _: Reader, parts: PartsOfRoom) -> ImageView:
    """One image's metadata."""
    with parts.database.read() as connection:
        return _view(connection, store.read_image(connection, image_id))


@router.get(
    "/images/{image_id}/original",
    response_class=Response,
    responses=answers_with("application/dicom", "image/png", "image/tiff"),
    openapi_extra=may_fail_with(ErrorCode.IMAGE_UNKNOWN),
)
def read_original(image_id: str, _: Reader, parts: PartsOfRoom) -> Response:
    """The bytes as they arrived, checked against their hash."""
    with parts.database.read() as connection:
        media_type = store.read_image(connection, image_id).source.get("media_type", "application/dicom")
        return Response(store.original_bytes(connection, image_id), media_type=media_type)


@router.get(
    "/images/{image_id}/findings",
    response_class=Response,
    responses=answers_with("image/png"),
    openapi_extra=may_fail_with(ErrorCode.IMAGE_UNKNOWN, ErrorCode.FINDINGS_UNKNOWN),
)
def read_findings(image_id: str, _: Reader, parts: PartsOfRoom) -> Response:
    """What was found in an image that was refused, and what failed, as a picture (PNG)."""
    with parts.database.read() as connection:
        return Response(findings_of(connection, image_id), media_type="image/png")


def _view(connection: Connection, image: StoredImage) -> ImageView:
    purpose = store.purpose_of(connection, image.id)
    return ImageView(
        **asdict(image),
        purpose=purpose.purpose if purpose else None,
        case_id=purpose.case_id if purpose else None,
        refused_by=[dict(one) for one in purpose.verdicts if not one["passed"]] if purpose else [],
    )
