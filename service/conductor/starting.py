"""The held button starts the approved motion: the permit is consumed in the record, then the guard is asked."""

from collections.abc import Callable

import numpy as np

from robot.errors import GuardDownError
from robot.frames import Transform
from robot.guard.messages import BeginMove
from robot.tool import Tool
from service.cases import store
from service.cases.records import ArtefactKind, Json, NewArtefact, StoredArtefact
from service.conductor.answers import CommandAnswer
from service.conductor.caller import Caller
from service.conductor.conductor import Conductor, new_id
from service.conductor.taking import Prepared, Standing
from service.errors import ErrorCode, ServiceError
from workflow.decisions import Decision
from workflow.facts import MoveStarted
from workflow.triggers import Trigger


def start_move(
    conductor: Conductor, caller: Caller, permit_id: str, check: Callable[[], None] = lambda: None
) -> CommandAnswer:
    """Start the motion of a permit; ServiceError with every verdict where it is refused. No packet goes out before.

    `check` raises a ServiceError where whoever holds may hold no longer: asked once nobody else can write, for the
    transaction may have been waited for.
    Where no guard takes the motion, the bridge tells a fault, which ends it in safe_hold: ServiceError guard_down.
    """

    def prepare(standing: Standing) -> Prepared:
        check()
        facts = MoveStarted(new_id(), permit_id, -1 if caller.control_token is None else caller.control_token)
        plan = _plan_of(standing, permit_id)
        if plan is None:
            return Prepared(facts)
        move = _move(permit_id, plan.content, standing.devices.tool)
        use = {"motion_id": facts.motion_id, "plan_id": plan.id, "kind": plan.content["kind"]}
        artefact = NewArtefact(ArtefactKind.PERMIT_USE, permit_id, (permit_id, plan.id), use, {})

        def begin(_: Decision) -> None:
            if not conductor.bridge.begin_move(move):
                raise ServiceError(GuardDownError.code, "no guard took the motion")

        return Prepared(facts, (artefact,), {"motion": facts.motion_id}, use, {"duration_s": move.duration_s}, begin)

    return conductor.perform(caller, Trigger.MOVE_STARTED, prepare)


def goal_of_permit(conductor: Conductor, case_id: str, permit_id: str) -> Transform:
    """Where the motion of a permit goes; ServiceError ARTEFACT_UNKNOWN if the case has no such permit."""
    with conductor.parts.database.read() as connection:
        permit = store.read_artefact(connection, ArtefactKind.PERMIT, permit_id)
        if permit.case_id != case_id:
            raise ServiceError(ErrorCode.ARTEFACT_UNKNOWN, "the permit belongs to another case")
        plan = store.read_artefact(connection, ArtefactKind.PLAN, str(permit.content["plan_id"]))
        return np.array(plan.content["base_from_goal"])


def _plan_of(standing: Standing, permit_id: str) -> StoredArtefact | None:
    """The plan that a permit was given for; None if there is no such permit, which the rules then say."""
    try:
        permit = store.read_artefact(standing.connection, ArtefactKind.PERMIT, permit_id)
    except ServiceError as error:
        if error.code != ErrorCode.ARTEFACT_UNKNOWN:
            raise
        return None
    return store.read_artefact(standing.connection, ArtefactKind.PLAN, str(permit.content["plan_id"]))


def _move(permit_id: str, plan: Json, tool: Tool) -> BeginMove:
    return BeginMove(
        permit_id=permit_id,
        base_from_goal=np.array(plan["base_from_goal"]),
        start_joints_rad=np.array(plan["start_joints_rad"]),
        speed_mm_s=plan["speed_mm_s"],
        acceleration_mm_s2=plan["acceleration_mm_s2"],
        duration_s=plan["duration_s"],
        flange_from_guide=tool.flange_from_guide,
        payload_kg=tool.payload_kg,
        payload_centre_mm=tool.payload_centre_mm,
        tcp_tolerance_mm=tool.tcp_tolerance_mm,
        tcp_tolerance_rad=tool.tcp_tolerance_rad,
        payload_tolerance_kg=tool.payload_tolerance_kg,
        payload_tolerance_mm=tool.payload_tolerance_mm,
    )
