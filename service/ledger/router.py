"""The ledger over HTTP: pages by filter, and the same as a file; to read it is an event itself."""

from dataclasses import asdict
from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query
from fastapi.responses import StreamingResponse

from service.audit import record_reading
from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.database.clock import as_utc
from service.database.tables import LARGEST_SEQUENCE
from service.ledger.exports import MEDIA_TYPES, ExportFormat, export
from service.ledger.listing import Wanted, page
from service.openapi import answers_with
from service.parts import Parts, parts_of

router = APIRouter(tags=["audit"])
AuditReader = Annotated[Session, Depends(require(Permission.READ_AUDIT))]
PartsOfRoom = Annotated[Parts, Depends(parts_of)]
Word = Annotated[str | None, Query(max_length=128)]
After = Annotated[int, Query(ge=0, le=LARGEST_SEQUENCE)]


def wanted_entries(
    case: Word = None,
    actor: Word = None,
    action: Word = None,
    interlock: Word = None,
    hazard: Word = None,
    since: datetime | None = None,
    until: datetime | None = None,
) -> Wanted:
    """Which entries a request asks for; a time without a zone is UTC."""
    times = [as_utc(at) if at is not None else None for at in (since, until)]
    return Wanted(case, actor, action, interlock, hazard, *times)


WantedEntries = Annotated[Wanted, Depends(wanted_entries)]


@router.get("/audit")
def read_audit(
    session: AuditReader,
    parts: PartsOfRoom,
    wanted: WantedEntries,
    after: After = 0,
    limit: Annotated[int, Query(ge=1, le=1000)] = 200,
) -> list[dict[str, Any]]:
    """Entries behind sequence `after`, oldest first: who did what, before and after, and the hashes of every row."""
    record_reading(parts.database, session.user_id, "audit", _asked(wanted, after))
    with parts.database.read() as connection:
        return page(connection, wanted, after, limit)


@router.get("/audit/export", response_class=StreamingResponse, responses=answers_with(*MEDIA_TYPES.values()))
def export_audit(
    session: AuditReader,
    parts: PartsOfRoom,
    wanted: WantedEntries,
    after: After = 0,
    form: Annotated[ExportFormat, Query(alias="format")] = ExportFormat.JSONL,
) -> StreamingResponse:
    """The same entries without an end: JSON Lines, CSV, DICOM audit messages (PS3.15 A.5) or FHIR AuditEvents."""
    record_reading(parts.database, session.user_id, "audit_export", _asked(wanted, after))
    return StreamingResponse(export(parts.database, wanted, form, after), media_type=MEDIA_TYPES[form])


def _asked(wanted: Wanted, after: int) -> dict[str, Any]:
    return {name: value for name, value in asdict(wanted).items() if value is not None} | {"after": after}
