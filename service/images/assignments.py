"""What a person said that an image is for: every word stays, the newest counts."""

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables

_ASSIGNMENTS = tables.image_assignments


def newest_assignments() -> sa.Subquery:
    """Image, case, purpose and verdicts of the newest assignment of every image that has one."""
    last = (
        sa.select(_ASSIGNMENTS.c.image_id, sa.func.max(_ASSIGNMENTS.c.number).label("number"))
        .group_by(_ASSIGNMENTS.c.image_id)
        .subquery()
    )
    same = (last.c.image_id == _ASSIGNMENTS.c.image_id) & (last.c.number == _ASSIGNMENTS.c.number)
    purpose = _ASSIGNMENTS.c.content["purpose"].as_string().label("purpose")
    columns = (_ASSIGNMENTS.c.image_id, _ASSIGNMENTS.c.case_id, purpose, _ASSIGNMENTS.c.content)
    return sa.select(*columns).join(last, same).subquery()


def count_assignments(connection: Connection, image_id: str) -> int:
    """How often an image was assigned."""
    query = sa.select(sa.func.max(_ASSIGNMENTS.c.number)).where(_ASSIGNMENTS.c.image_id == image_id)
    return connection.execute(query).scalar() or 0
