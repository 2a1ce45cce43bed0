"""A restart: the open case goes to safe_hold with its history whole, and with what the journal knows of its motions."""

from service.conductor.conductor import Conductor
from service.conductor.taking import Prepared, Standing
from service.motion.trajectories import unfinished_motions
from workflow.facts import Restarted
from workflow.triggers import Trigger


def recover(conductor: Conductor) -> None:
    """Record the restart in the room's open case, if it has one."""
    case_id = conductor.open_case()
    if case_id is None:
        return

    def prepare(standing: Standing) -> Prepared:
        motions = unfinished_motions(standing.connection, case_id, conductor.journal_folder)
        made = {"motion": motions[-1].id} if motions else {}
        return Prepared(Restarted(), motions, made, {"imported_motions": [motion.id for motion in motions]})

    conductor.observe(case_id, Trigger.RESTARTED, prepare)
