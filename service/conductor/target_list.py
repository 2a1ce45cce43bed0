"""What became of each planned target: from the events alone."""

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.cases import store
from service.database import tables
from workflow.triggers import Trigger


def target_states(connection: Connection, case_id: str) -> dict[str, str]:
    """Every planned target with `open`, `placed` or `abandoned`; the last attempt counts, a placed one stays placed."""
    states = dict.fromkeys(store.planned_targets(connection, case_id), "open")
    events = tables.events
    done = (events.c.case_id == case_id, events.c.trigger == Trigger.TARGET_DONE)
    for data in connection.execute(sa.select(events.c.data).where(*done).order_by(events.c.sequence)).scalars():
        name = data.get("planned_target")
        if name in states and states[name] != "placed":
            states[name] = "placed" if data["placed"] else "abandoned"
    return states
