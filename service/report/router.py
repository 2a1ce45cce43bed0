"""The report of a case over HTTP, for whoever may read the case."""

from typing import Annotated

from fastapi import APIRouter, Depends
from fastapi.responses import Response

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.errors import ErrorCode
from service.openapi import may_fail_with
from service.parts import Parts, parts_of
from service.report.making import make_report

router = APIRouter(tags=["cases"])


@router.get(
    "/cases/{case_id}/report",
    response_class=Response,
    responses={200: {"content": {"application/pdf": {}}, "description": "PDF/A-2b"}},
    openapi_extra=may_fail_with(
        ErrorCode.CASE_UNKNOWN, ErrorCode.VISION_DEADLINE, ErrorCode.VISION_CRASHED, ErrorCode.VISION_OUT_OF_MEMORY
    ),
    dependencies=[Depends(require(Permission.READ))],
)
async def read_report(case_id: str, parts: Annotated[Parts, Depends(parts_of)]) -> Response:
    """Devices, images, errors, moves, dose, times, interlocks, overrides, stops, sign-offs: PDF/A, of any case."""
    content = await make_report(parts.database, parts.vision, case_id)
    named = {"Content-Disposition": f'inline; filename="case-{case_id}.pdf"'}
    return Response(content, media_type="application/pdf", headers=named)
