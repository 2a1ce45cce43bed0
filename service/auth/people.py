"""The names behind the ids of the record."""

from typing import Annotated

from fastapi import APIRouter, Depends

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.auth.session import Session
from service.auth.users import user_names
from service.parts import Parts, parts_of

router = APIRouter(tags=["session"])


@router.get("/people")
def read_people(
    _: Annotated[Session, Depends(require(Permission.READ))], parts: Annotated[Parts, Depends(parts_of)]
) -> dict[str, str]:
    """Names by user id, of those who left too: events, leases and permits name a person by id."""
    with parts.database.read() as connection:
        return user_names(connection)
