"""Motions as the record keeps them: how they ended, and the trajectory that the guard's journal has."""

import gzip
import math
from pathlib import Path
from typing import Any

import structlog
from sqlalchemy.engine import Connection

from robot.guard.journal import EVENTS_FILE, read_lines, trajectory_file
from robot.guard.messages import MotionEnded
from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact, StoredArtefact

_log = structlog.get_logger(__name__)


def motion_artefact(use: StoredArtefact, folder: Path, content: dict[str, Any]) -> NewArtefact:
    """The motion of a used permit, with its trajectory (JSON lines at the controller's rate, gzip) if there is one."""
    trajectory = _trajectory(folder / trajectory_file(use.id))
    made_from = (str(use.content["plan_id"]), use.id)
    columns = {"trajectory": trajectory}
    return NewArtefact(ArtefactKind.MOTION, str(use.content["motion_id"]), made_from, content, columns)


def _trajectory(path: Path) -> bytes | None:
    """The file, compressed; None if there is none to be read: that a motion is over is recorded without it."""
    try:
        return gzip.compress(path.read_bytes()) if path.exists() else None
    except OSError as error:
        _log.error("trajectory_unreadable", file=path.name, error=repr(error))
        return None


def ending(ended: MotionEnded) -> dict[str, Any]:
    """How a motion ended."""
    return {
        "cause": ended.cause.value,
        "at_rest": ended.at_rest,
        "program_stopped": ended.program_stopped,
        "distance_mm": ended.distance_mm,
        "angle_deg": None if ended.angle_rad is None else math.degrees(ended.angle_rad),
        "base_from_tcp": None if ended.arm is None else ended.arm.base_from_tcp.tolist(),
        "joints_rad": None if ended.arm is None else ended.arm.joints_rad.tolist(),
        "trajectory_samples": ended.trajectory_samples,
    }


def unfinished_motions(connection: Connection, case_id: str, folder: Path) -> tuple[NewArtefact, ...]:
    """Motions that were started and whose end no run of the service recorded: what the journal knows of them."""
    recorded = {motion.id for motion in store.artefacts_of(connection, ArtefactKind.MOTION, case_id)}
    uses = store.artefacts_of(connection, ArtefactKind.PERMIT_USE, case_id)
    ends = {line["permit_id"]: line for line in read_lines(folder / EVENTS_FILE) if _is_end(line)}
    return tuple(
        motion_artefact(use, folder, _journalled(ends.get(use.id)))
        for use in uses
        if use.content["motion_id"] not in recorded
    )


def _is_end(line: dict[str, Any]) -> bool:
    return line.get("type") == "motion_ended" and "permit_id" in line


def _journalled(line: dict[str, Any] | None) -> dict[str, Any]:
    if line is None:
        return {"cause": "unknown", "imported": True}
    kept = ("cause", "at_rest", "program_stopped", "distance_mm", "trajectory_samples")
    return {"imported": True} | {name: line.get(name) for name in kept}
