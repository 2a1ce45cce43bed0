"""The pixels of an image for a screen: all their bits, windowed where they are seen."""

import asyncio
from typing import Annotated

from fastapi import APIRouter, Depends, Response

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.errors import ErrorCode, ServiceError
from service.images.store import original_bytes
from service.openapi import answers_with, may_fail_with
from service.parts import Parts, parts_of

router = APIRouter(tags=["images"])


@router.get(
    "/images/{image_id}/pixels",
    response_class=Response,
    responses=answers_with("application/octet-stream"),
    dependencies=[Depends(require(Permission.READ))],
    openapi_extra=may_fail_with(
        ErrorCode.IMAGE_UNKNOWN,
        ErrorCode.NOT_AN_IMAGE,
        ErrorCode.VISION_DEADLINE,
        ErrorCode.VISION_CRASHED,
        ErrorCode.VISION_OUT_OF_MEMORY,
    ),
)
async def read_pixels(image_id: str, parts: Annotated[Parts, Depends(parts_of)]) -> Response:
    """Rows of unsigned 16-bit numbers, little-endian, dark where the beam was absorbed; their number is in the headers.

    Decoded by the image worker, as everything that arrived from outside.
    """
    async with parts.vision.turns_to_show:
        original = await asyncio.to_thread(_original, parts, image_id)
        decoded = await parts.vision.run("pixels", original)
    if decoded["status"] == "refused":
        raise ServiceError(ErrorCode.NOT_AN_IMAGE, decoded["reason"]["message"])
    headers = {f"Image-{name}": str(decoded[name.lower()]) for name in ("Rows", "Columns", "Bits")}
    return Response(decoded["pixels"], headers=headers, media_type="application/octet-stream")


def _original(parts: Parts, image_id: str) -> bytes:
    with parts.database.read() as connection:
        return original_bytes(connection, image_id)
