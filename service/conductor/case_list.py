"""Cases as a list shows them, without a word of the patient: what an auditor finds a case by."""

from collections import Counter
from dataclasses import dataclass

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.cases import store
from service.conductor.target_list import target_states
from service.database import tables


@dataclass(frozen=True, slots=True)
class ListedCase:
    """When and where a case was, who opened it, how far it came; times in UTC, targets counted."""

    id: str
    opened_at: str
    ended_at: str | None
    state: str
    room: str
    opened_by: str
    targets_placed: int
    targets_abandoned: int
    targets_planned: int


def listed_cases(connection: Connection, limit: int, before: str | None) -> list[ListedCase]:
    """So many cases, newest first, all or those before one; ServiceError CASE_UNKNOWN."""
    cases = store.list_cases(connection, limit, before)
    ids = [case.id for case in cases]
    standings, ends = store.standings(connection, ids), store.ends(connection, ids)
    users = tables.users.c
    known = connection.execute(sa.select(users.id, users.name).where(users.id.in_({one.opened_by for one in cases})))
    names = {row.id: row.name for row in known}
    listed = []
    for case in cases:
        states = target_states(connection, case.id)
        counted = Counter(states.values())
        listed.append(
            ListedCase(
                id=case.id,
                opened_at=case.opened_at,
                ended_at=ends.get(case.id),
                state=standings[case.id]["state"],
                room=case.room,
                opened_by=names[case.opened_by],
                targets_placed=counted["placed"],
                targets_abandoned=counted["abandoned"],
                targets_planned=len(states),
            )
        )
    return listed
