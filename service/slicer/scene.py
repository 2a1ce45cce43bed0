"""What stands now, for whoever watches in 3D Slicer: read from the record and the arm, never changed."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from sqlalchemy.engine import Connection

from robot.frames import Transform
from service.cases import store
from service.cases.records import ArtefactKind, Json
from service.images.store import list_images
from service.parts import Parts
from service.slicer.messages import target_beyond


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """The open case of the room at one moment; `goal` and `target` in the arm's base, None where none is planned."""

    state: dict[str, Any]
    goal: Transform | None
    target: Transform | None
    image_id: str | None


_NOBODY = Scene({"case": None, "state": "no_case"}, None, None, None)


def read_scene(parts: Parts) -> Scene:
    """The room's open case, if it has one."""
    with parts.database.read() as connection:
        case_id = store.open_case_of(connection, parts.settings.room)
        if case_id is None:
            return _NOBODY
        last = store.newest_event(connection, case_id)
        goal, target = _aims(connection, last.case_state)
        state = {"case": case_id, "state": last.state, "version": last.version}
        newest = next(iter(list_images(connection, case_id, limit=1)), None)
        return Scene(state, goal, target, newest.id if newest is not None else None)


def _aims(connection: Connection, case: Json) -> tuple[Transform | None, Transform | None]:
    plan, aimed = case.get("plan"), case.get("target")
    if plan is None:
        return None, None
    content = store.read_artefact(connection, ArtefactKind.PLAN, plan["id"]).content
    base_from_goal = np.array(content["base_from_goal"], dtype=np.float64)
    if aimed is None or plan["kind"] not in ("targeting", "corrective"):
        return base_from_goal, None
    target = store.read_artefact(connection, ArtefactKind.TARGET, aimed["id"]).content
    found = store.read_artefact(connection, ArtefactKind.REGISTRATION, target["registration_id"]).content
    return base_from_goal, target_beyond(base_from_goal, found["guide"]["separation_mm"], target["depth_mm"])
