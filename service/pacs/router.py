"""The worklist, and what a case left to the archive."""

from dataclasses import asdict
from typing import Annotated

from fastapi import APIRouter, Depends, Query
from pydantic import BaseModel

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.cases import store
from service.errors import ErrorCode
from service.openapi import may_fail_with
from service.pacs.outbox import objects_of
from service.pacs.worklist import find_scheduled
from service.parts import Parts, parts_of

router = APIRouter(tags=["hospital"])
PartsOfRoom = Annotated[Parts, Depends(parts_of)]


class ScheduledView(BaseModel):
    """A scheduled procedure step of the hospital's worklist."""

    patient_id: str
    patient_name: str
    birth_date: str
    sex: str
    study_uid: str
    accession_number: str
    description: str
    scheduled_at: str
    station: str


class SentObject(BaseModel):
    """An object for the archive; `answer` is the newest, null before the first."""

    id: str
    kind: str
    sop_class: str
    queued_at: str
    delivered: bool
    answer: str | None


@router.get("/worklist", openapi_extra=may_fail_with(ErrorCode.PEER_UNKNOWN, ErrorCode.PEER_UNREACHABLE))
def read_worklist(
    _: Annotated[Session, Depends(require(Permission.OPEN_CASE))],
    parts: PartsOfRoom,
    date: Annotated[str, Query(pattern=r"^(\d{8})?(-\d{8})?$")] = "",
    patient_id: Annotated[str, Query(alias="patient", max_length=64, pattern=r"^[^*?\\]*$")] = "",
) -> list[ScheduledView]:
    """What is scheduled, on a date (YYYYMMDD, or a range with a hyphen) or for a patient where named."""
    found = find_scheduled(parts.settings.worklist, parts.settings.dicom.ae_title, date, patient_id)
    return [ScheduledView(**asdict(entry)) for entry in found]


@router.get("/cases/{case_id}/sent", openapi_extra=may_fail_with(ErrorCode.CASE_UNKNOWN))
def read_sent(
    case_id: str, _: Annotated[Session, Depends(require(Permission.READ))], parts: PartsOfRoom
) -> list[SentObject]:
    """What the case left to the archive, and whether it was acknowledged."""
    with parts.database.read() as connection:
        store.read_case(connection, case_id)
        return [SentObject.model_validate(asdict(one)) for one in objects_of(connection, case_id)]
