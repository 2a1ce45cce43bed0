"""A case as one file over HTTP, for whoever may read the record."""

import tempfile
from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Depends
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask

from service.archive.exporting import export_case
from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.errors import ErrorCode
from service.openapi import answers_with, may_fail_with
from service.parts import Parts, parts_of

router = APIRouter(tags=["audit"])


@router.get(
    "/cases/{case_id}/export",
    response_class=FileResponse,
    responses=answers_with("application/zip"),
    openapi_extra=may_fail_with(ErrorCode.CASE_UNKNOWN, ErrorCode.ARCHIVE_REFUSED),
)
def read_archive(
    case_id: str,
    session: Annotated[Session, Depends(require(Permission.READ_AUDIT))],
    parts: Annotated[Parts, Depends(parts_of)],
    pseudonymise: bool = False,
) -> FileResponse:
    """Everything that was recorded of a case, with its proof, as `coaxial case export` writes it."""
    signer = parts.database.signer
    if signer is None:
        raise AssertionError("a service without a key would sign no archive")
    with tempfile.NamedTemporaryFile(prefix="coaxial-", suffix=".zip", delete=False) as file:
        out = Path(file.name)
    remove = BackgroundTask(out.unlink, missing_ok=True)
    try:
        export_case(parts.database, signer, case_id, session.user_id, out, pseudonymised=pseudonymise)
    except BaseException:
        out.unlink(missing_ok=True)
        raise
    name = f"case-{case_id}{'-pseudonymised' if pseudonymise else ''}.zip"
    return FileResponse(out, media_type="application/zip", filename=name, background=remove)
