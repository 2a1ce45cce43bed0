"""Images that come over HTTP: DICOM as from the C-arm; what names no patient waits for a person's statement."""

from typing import Annotated, Any

import structlog
from fastapi import APIRouter, Depends, Header, Request
from pydantic import BaseModel
from sqlalchemy.engine import Connection
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import UploadFile

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.errors import ErrorCode, ServiceError
from service.images.dicom_header import DicomHeader, read_header
from service.images.store import AWAITS_STATEMENT, StoredImage, add_image, image_sent_again, waiting_image
from service.openapi import may_fail_with
from service.parts import Parts, parts_of
from vision.refusal import RefusalCode

router = APIRouter(tags=["images"])
_log = structlog.get_logger(__name__)
_DICOM = "application/dicom"
_PICTURES = ("image/png", "image/tiff")
_FORM, _FIELD = "multipart/form-data", "image"
_FILE = {"type": "object", "properties": {_FIELD: {"type": "string", "format": "binary"}}, "required": [_FIELD]}
_SCHEMAS: dict[str, Any] = {**{kind: {} for kind in (_DICOM, *_PICTURES)}, _FORM: _FILE}
_BODY: dict[str, Any] = {
    "requestBody": {"required": True, "content": {kind: {"schema": one} for kind, one in _SCHEMAS.items()}}
}
_UPLOADING = may_fail_with(
    ErrorCode.MEDIA_TYPE_UNKNOWN,
    ErrorCode.NOT_AN_IMAGE,
    ErrorCode.IMAGE_BYTES_TOO_LARGE,
    ErrorCode.IMAGE_TOO_SMALL,
    ErrorCode.IMAGE_TRUNCATED,
    ErrorCode.SEVERAL_FRAMES,
    ErrorCode.IMAGE_UID_TAKEN,
    RefusalCode.UNREADABLE_IMAGE,
    RefusalCode.UNSUPPORTED_IMAGE,
    RefusalCode.IMAGE_TOO_LARGE,
    ErrorCode.VISION_DEADLINE,
    ErrorCode.VISION_CRASHED,
    ErrorCode.VISION_OUT_OF_MEMORY,
)


class UploadAnswer(BaseModel):
    """The image as it is stored; whether a person must state whose it is before it enters a case."""

    id: str
    sha256: str
    pixel_sha256: str | None
    duplicate_of: str | None
    awaits_statement: bool


@router.post("/images", status_code=201, openapi_extra=_BODY | _UPLOADING)
async def upload_image(
    request: Request,
    session: Annotated[Session, Depends(require(Permission.EXPOSE))],
    parts: Annotated[Parts, Depends(parts_of)],
    content_type: Annotated[str, Header()] = "",
) -> UploadAnswer:
    """Store one image, the body of the request or the file `image` of a form; what is no usable one is not kept.

    DICOM with its UIDs goes the way of one from the C-arm. PNG, TIFF and DICOM without them wait for
    `image-identity-stated`; the same bytes sent again while they wait are the same image.
    """
    kind, content = await _sent(request, content_type)
    header = await _header(parts, kind, content)
    source = {"uploaded_by": session.user_id, "media_type": kind}
    image = await run_in_threadpool(_store, parts, content, header, source)
    return UploadAnswer(
        id=image.id,
        sha256=image.sha256,
        pixel_sha256=image.pixel_sha256,
        duplicate_of=image.duplicate_of,
        awaits_statement=_awaits_statement(header),
    )


async def _sent(request: Request, content_type: str) -> tuple[str, bytes]:
    """Media type and bytes: of the body, or of the one file of a form; the edge counts both as they come."""
    kind = _media_type(content_type)
    if kind != _FORM:
        return kind, await request.body()
    async with request.form(max_files=1, max_fields=0) as form:
        file = form.get(_FIELD)
        if not isinstance(file, UploadFile):
            raise ServiceError(ErrorCode.MALFORMED_REQUEST, f"the form holds no file called {_FIELD}")
        return _media_type(file.content_type or ""), await file.read()


def _media_type(content_type: str) -> str:
    return content_type.partition(";")[0].strip().lower()


async def _header(parts: Parts, kind: str, content: bytes) -> DicomHeader:
    if kind in _PICTURES:
        return _picture_header(await parts.vision.run("identify", content))
    if kind != _DICOM:
        allowed = ", ".join((_DICOM, *_PICTURES))
        raise ServiceError(ErrorCode.MEDIA_TYPE_UNKNOWN, "no image is of this type", measured=kind, limit=allowed)
    header, problem = await run_in_threadpool(read_header, content, parts.settings.dicom, by_statement=True)
    if problem is not None:
        raise problem
    return header


def _picture_header(found: dict[str, Any]) -> DicomHeader:
    if found["status"] == "refused":
        reason = found["reason"]
        raise ServiceError(reason["code"], reason["message"], measured=reason["measured"], limit=reason["limit"])
    metadata = {"rows": found["rows"], "columns": found["columns"], "frames": 1}
    return DicomHeader(None, None, None, found["pixel_sha256"], metadata)


def _store(parts: Parts, content: bytes, header: DicomHeader, source: dict[str, Any]) -> StoredImage:
    waits = _awaits_statement(header)
    with parts.database.write(bulky=True) as connection:
        known = waiting_image(connection, content) if waits else image_sent_again(connection, content, header)
        image = known or _add(connection, content, header, source | ({AWAITS_STATEMENT: True} if waits else {}))
    if known is None and not waits:
        parts.arrivals.announce(image.id)
    return image


def _add(connection: Connection, content: bytes, header: DicomHeader, source: dict[str, Any]) -> StoredImage:
    image = add_image(connection, content, header, None, source)
    _log.info("image_uploaded", image_id=image.id, duplicate=image.duplicate_of is not None)
    return image


def _awaits_statement(header: DicomHeader) -> bool:
    return None in (header.sop_uid, header.patient_id, header.study_uid)
