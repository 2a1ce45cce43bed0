"""The trends over HTTP, for whoever may read the record."""

from typing import Annotated, Any

from fastapi import APIRouter, Depends

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.errors import ErrorCode
from service.openapi import may_fail_with
from service.parts import Parts, parts_of
from service.trends.figures import finished_cases
from service.trends.series import chart_trends, to_json

router = APIRouter(tags=["audit"])


@router.get(
    "/trends",
    openapi_extra=may_fail_with(ErrorCode.TOO_FEW_CASES),
    dependencies=[Depends(require(Permission.READ_AUDIT))],
)
def read_trends(parts: Annotated[Parts, Depends(parts_of)]) -> dict[str, Any]:
    """Errors, residuals, distortion, exposures and time across cases by device, with what drifts."""
    with parts.database.read() as connection:
        cases = finished_cases(connection)
    return to_json(chart_trends(cases))
