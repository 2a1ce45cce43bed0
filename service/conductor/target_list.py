"""What became of each planned target: from the events alone."""

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.cases import store
from service.database import tables
from workflow.triggers import Trigger

_DONE = (
    sa.select(tables.events.c.data)
    .where(tables.events.c.case_id == sa.bindparam("case_id"), tables.events.c.trigger == Trigger.TARGET_DONE)
    .order_by(tables.events.c.sequence)
)


def target_states(connection: Connection, case_id: str) -> dict[str, str]:
    """Every planned target with `open`, `placed` or `abandoned`; the last attempt counts, a placed one stays placed."""
    states = dict.fromkeys(store.planned_targets(connection, case_id), "open")
    for data in connection.execute(_DONE, {"case_id": case_id}).scalars():
        name = data.get("planned_target")
        if name in states and states[name] != "placed":
            states[name] = "placed" if data["placed"] else "abandoned"
    return states
