"""A plan from 3D Slicer, as what a case is opened with."""

from fastapi import APIRouter, Depends, Request

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.cases.opening import PlannedTarget
from service.errors import ErrorCode
from service.openapi import may_fail_with
from service.slicer.markups import planned_targets_from

router = APIRouter(tags=["hospital"])
_FILE = {"requestBody": {"required": True, "content": {"application/json": {"schema": {"type": "object"}}}}}


@router.post(
    "/plans/markups",
    dependencies=[Depends(require(Permission.OPEN_CASE))],
    openapi_extra=may_fail_with(ErrorCode.MARKUPS_REFUSED) | _FILE,
)
async def read_markups(request: Request) -> list[PlannedTarget]:
    """The planned targets of a markups file (.mrk.json), in patient coordinates; nothing is stored."""
    return planned_targets_from(await request.body())
