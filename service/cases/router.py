"""Cases: open, list, read; what was attempted and what was recorded."""

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Response
from pydantic import BaseModel
from sqlalchemy.engine import Connection

from service.audit import record_reading
from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.cases import attempts, store
from service.cases.idempotency import Intent, KeptAnswer, keep_answer, kept_answer
from service.cases.opening import CaseToOpen, open_case
from service.cases.preconditions import etag, intent
from service.cases.records import StoredCase
from service.database.tables import LARGEST_SEQUENCE
from service.errors import ErrorCode
from service.openapi import may_fail_with
from service.parts import Parts, parts_of

router = APIRouter(tags=["cases"])
Reader = Annotated[Session, Depends(require(Permission.READ))]
AuditReader = Annotated[Session, Depends(require(Permission.READ_AUDIT))]
PartsOfRoom = Annotated[Parts, Depends(parts_of)]
_MOST_ATTEMPTS = 5000  # in one answer: many times what a case comes to
_MOST_CASES = 1000


class CaseView(BaseModel):
    """A case with its state and version."""

    id: str
    room: str
    patient_id: str
    study_uid: str
    opened_at: str
    opened_by: str
    product_version: str
    settings_sha256: str
    devices: dict[str, str]
    state: str
    version: int
    sequence: int


class CaseWithTargets(CaseView):
    """A case with its planned targets by name."""

    planned_targets: dict[str, Any]


@router.post(
    "/cases",
    status_code=201,
    openapi_extra=may_fail_with(
        ErrorCode.CASE_OPEN,
        ErrorCode.DEVICE_UNKNOWN,
        ErrorCode.DEVICE_EXPIRED,
        ErrorCode.IDEMPOTENCY_KEY_MISSING,
        ErrorCode.IDEMPOTENCY_KEY_REUSED,
    ),
)
def open_new_case(
    body: CaseToOpen,
    response: Response,
    session: Annotated[Session, Depends(require(Permission.OPEN_CASE))],
    meant: Annotated[Intent, Depends(intent)],
    parts: PartsOfRoom,
) -> CaseWithTargets:
    """Open a case for one patient and study; the room can have one open case."""
    with parts.database.write() as connection:
        answer = kept_answer(connection, meant)
        if answer is None:
            event = open_case(connection, body, session, parts.settings)
            view = _with_targets(connection, event.case_id)
            answer = KeptAnswer(201, view.model_dump(), event.version)
            keep_answer(connection, meant, answer)
    response.headers["ETag"] = etag(answer.version or 0)
    return CaseWithTargets(**answer.body)


@router.get("/cases", openapi_extra=may_fail_with(ErrorCode.CASE_UNKNOWN))
def list_cases(
    _: Reader,
    parts: PartsOfRoom,
    limit: Annotated[int, Query(ge=1, le=_MOST_CASES)] = 100,
    before: Annotated[str | None, Query(max_length=64)] = None,
) -> list[CaseView]:
    """The newest cases, newest first, the room's open one always among them; with `before`, those behind that case."""
    with parts.database.read() as connection:
        cases = store.list_cases(connection, limit, before)
        open_id = store.open_case_of(connection, parts.settings.room) if before is None else None
        if open_id is not None and all(case.id != open_id for case in cases):  # older, by a clock that was put back
            cases.append(store.read_case(connection, open_id))
        standings = store.standings(connection, [case.id for case in cases])
    return [CaseView(**asdict(case), **standings[case.id]) for case in cases]


@router.get("/cases/{case_id}", openapi_extra=may_fail_with(ErrorCode.CASE_UNKNOWN))
def read_one_case(case_id: str, response: Response, _: Reader, parts: PartsOfRoom) -> CaseWithTargets:
    """One case with its planned targets."""
    with parts.database.read() as connection:
        view = _with_targets(connection, case_id)
    response.headers["ETag"] = etag(view.version)
    return view


@router.get("/cases/{case_id}/audit", openapi_extra=may_fail_with(ErrorCode.CASE_UNKNOWN))
def read_case_record(
    case_id: str, session: AuditReader, parts: PartsOfRoom, after: Annotated[int, Query(ge=0, le=LARGEST_SEQUENCE)] = 0
) -> list[dict[str, Any]]:
    """The events of a case behind sequence `after`, each with the whole state after it."""
    record_reading(parts.database, session.user_id, "case", {"case": case_id, "after": after})
    with parts.database.read() as connection:
        store.read_case(connection, case_id)
        return [asdict(event) for event in store.events_after(connection, case_id, after)]


@router.get("/interlocks")
def read_interlocks(
    session: AuditReader,
    parts: PartsOfRoom,
    case_id: Annotated[str | None, Query(alias="case")] = None,
    limit: Annotated[int, Query(ge=1, le=_MOST_ATTEMPTS)] = 200,
) -> list[dict[str, Any]]:
    """The newest attempts, accepted or refused, with the verdict of every interlock."""
    record_reading(parts.database, session.user_id, "interlocks", {"case": case_id})
    with parts.database.read() as connection:
        return attempts.list_attempts(connection, case_id, limit)


def _view(connection: Connection, case: StoredCase) -> CaseView:
    last = store.newest_event(connection, case.id)
    return CaseView(**asdict(case), state=last.state, version=last.version, sequence=last.sequence)


def _with_targets(connection: Connection, case_id: str) -> CaseWithTargets:
    view = _view(connection, store.read_case(connection, case_id))
    return CaseWithTargets(**view.model_dump(), planned_targets=store.planned_targets(connection, case_id))
