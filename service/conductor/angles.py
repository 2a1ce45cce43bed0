"""The C-arm's angles for a planned target: how it must stand so that the path projects to a point."""

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Depends

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.cases import store
from service.conductor.answers import CArmAnglesAnswer
from service.conductor.image_work import accepted
from service.conductor.route_errors import ANGLES
from service.errors import ErrorCode, ServiceError
from service.parts import Parts, parts_of

router = APIRouter(tags=["images of a case"])
_READER = [Depends(require(Permission.READ))]


@router.get(
    "/cases/{case_id}/planned-targets/{name}/carm-angles",
    openapi_extra=ANGLES,
    dependencies=[Depends(require(Permission.READ))],
)
async def read_carm_angles(case_id: str, name: str, parts: Annotated[Parts, Depends(parts_of)]) -> CArmAnglesAnswer:
    """DICOM positioner angles, what the dial shows, and the same in words."""
    plan = await asyncio.to_thread(_plan, parts, case_id, name)
    angles = accepted(await parts.vision.carm_angles(plan["entry_mm"], plan["target_mm"], plan["position"]))
    return CArmAnglesAnswer(target=name, **{key: value for key, value in angles.items() if key != "status"})


def _plan(parts: Parts, case_id: str, name: str) -> dict[str, Any]:
    with parts.database.read() as connection:
        store.read_case(connection, case_id)
        plans = store.planned_targets(connection, case_id)
    if name not in plans:
        raise ServiceError(ErrorCode.PLANNED_TARGET_UNKNOWN, f"the case has no planned target {name}")
    plan: dict[str, Any] = plans[name]
    return plan
