"""The links of a case's chain as they were recorded: what a screen shows of a plan, a target, an evaluation."""

from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Depends
from pydantic import BaseModel

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.cases import store
from service.cases.records import ArtefactKind, StoredArtefact
from service.errors import ErrorCode, ServiceError
from service.openapi import may_fail_with
from service.parts import Parts, parts_of

router = APIRouter(tags=["cases"])
Reader = Annotated[Session, Depends(require(Permission.READ))]
PartsOfRoom = Annotated[Parts, Depends(parts_of)]


class ArtefactView(BaseModel):
    """One link, with what it was made from."""

    id: str
    kind: ArtefactKind
    sequence: int
    made_from: tuple[str, ...]
    content: Mapping[str, Any]
    recorded_at: str


@router.get(
    "/cases/{case_id}/artefacts/{kind}/{artefact_id}",
    openapi_extra=may_fail_with(ErrorCode.ARTEFACT_UNKNOWN),
)
def read_one_artefact(
    case_id: str, kind: ArtefactKind, artefact_id: str, _: Reader, parts: PartsOfRoom
) -> ArtefactView:
    """One link of this case; another case's is unknown here."""
    with parts.database.read() as connection:
        artefact = store.read_artefact(connection, kind, artefact_id)
    if artefact.case_id != case_id:
        raise ServiceError(ErrorCode.ARTEFACT_UNKNOWN, f"the case has no row {artefact_id} in {kind}")
    return _view(kind, artefact)


@router.get("/cases/{case_id}/artefacts/{kind}", openapi_extra=may_fail_with(ErrorCode.CASE_UNKNOWN))
def list_artefacts(case_id: str, kind: ArtefactKind, _: Reader, parts: PartsOfRoom) -> list[ArtefactView]:
    """Every link of one kind, oldest first."""
    with parts.database.read() as connection:
        store.read_case(connection, case_id)
        return [_view(kind, artefact) for artefact in store.artefacts_of(connection, kind, case_id)]


def _view(kind: ArtefactKind, artefact: StoredArtefact) -> ArtefactView:
    return ArtefactView(
        id=artefact.id,
        kind=kind,
        sequence=artefact.sequence,
        made_from=artefact.made_from,
        content=artefact.content,
        recorded_at=artefact.recorded_at,
    )
