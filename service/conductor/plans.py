"""Plans: a goal, the checked way there, and what was predicted of it."""

import math
from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Depends

from robot.arm import ArmState
from robot.path import Path
from robot.path_limits import PathLimits
from service.auth.permissions import Permission
from service.cases.records import ArtefactKind, NewArtefact
from service.conductor.answers import CommandAnswer
from service.conductor.bodies import RequestPlan
from service.conductor.caller import Caller, requesting
from service.conductor.conductor import Conductor, TheConductor, new_id
from service.conductor.goals import Goal, goal_of, way_to
from service.conductor.plan_content import plan_content
from service.conductor.route_errors import PLANNING
from service.conductor.taking import Prepared, Standing
from service.errors import ErrorCode, ServiceError
from workflow.facts import PlanRequested
from workflow.limits import Limits
from workflow.machine import decide
from workflow.motion_interlocks import input_ids
from workflow.overrides import Override
from workflow.plans import PlanKind
from workflow.refusals import Refusal
from workflow.triggers import Trigger

router = APIRouter(tags=["motions of a case"])
_WAIT_S = 0.3


@router.post("/cases/{case_id}/plan-requested", openapi_extra=PLANNING)
def plan_requested(
    body: RequestPlan, caller: Annotated[Caller, Depends(requesting(Permission.PLAN))], conductor: TheConductor
) -> CommandAnswer:
    """A plan of one kind from where the arm is now; it moves nothing."""
    overrides = caller.overriding(body.overrides)
    return conductor.perform(
        caller, Trigger.PLAN_REQUESTED, lambda standing: _prepare(conductor, standing, body, overrides)
    )


def _prepare(
    conductor: Conductor, standing: Standing, wanted: RequestPlan, overrides: tuple[Override, ...]
) -> Prepared:
    """The rules first: what is not allowed now is refused for that, not for a path that nobody may go."""
    rules = conductor.rules
    still = replace(_still(standing, wanted.kind, rules.limits), overrides=overrides)
    answer = decide(standing.case, Trigger.PLAN_REQUESTED, still, standing.snapshot, rules.limits, rules.clock())
    if isinstance(answer, Refusal):
        return Prepared(still)
    reading = conductor.bridge.watch.reading(_WAIT_S)
    if reading is None or reading.arm is None:
        raise ServiceError(ErrorCode.ARM_UNKNOWN, "nothing was read from the arm yet")
    goal = goal_of(standing.connection, standing.case, wanted, reading.arm)
    path = way_to(goal, reading.arm, standing.devices)
    return _planned(still, wanted, goal, path, reading.arm)


def _still(standing: Standing, kind: PlanKind, limits: Limits) -> PlanRequested:
    """A plan of this kind that goes nowhere and keeps every limit of a path, so that only the case can refuse it."""
    return PlanRequested(
        plan_id=new_id(),
        kind=kind,
        axial=kind is PlanKind.RETREAT,
        made_from=tuple(id_ for id_ in input_ids(standing.case, kind) if id_),
        start_joints_rad=(),
        length_mm=0.0,
        rotation_rad=0.0,
        speed_mm_s=0.0,
        speed_rad_s=0.0,
        acceleration_mm_s2=0.0,
        joint_margin_rad=limits.joint_margin_rad,
        smallest_singular_value=limits.smallest_singular_value,
        clearance_mm=limits.clearance_mm,
        clearance_needed_mm=limits.clearance_mm,
        predicted_angle_rad=0.0,
        predicted_position_mm=0.0,
    )


def _planned(still: PlanRequested, wanted: RequestPlan, goal: Goal, path: Path, arm: ArmState) -> Prepared:
    way_mm = max(path.length_mm, path.angle_rad * PathLimits().turn_lever_mm)  # what the controller counts
    predicted = goal.predicted["predicted_error_95"]
    facts = replace(
        still,
        start_joints_rad=tuple(map(float, path.start_joints_rad)),
        length_mm=path.length_mm,
        rotation_rad=path.angle_rad,
        speed_mm_s=path.speed_mm_s,
        speed_rad_s=path.angle_rad * path.speed_mm_s / way_mm if way_mm > 0.0 else 0.0,
        acceleration_mm_s2=path.acceleration_mm_s2,
        joint_margin_rad=path.joint_margin_rad,
        smallest_singular_value=path.smallest_singular_value,
        clearance_mm=path.clearance_mm,
        clearance_needed_mm=path.needed_mm,
        predicted_angle_rad=None if predicted is None else math.radians(predicted["angle_deg"]),
        predicted_position_mm=None if predicted is None else predicted["position_mm"],
    )
    content = plan_content(facts.kind, goal, arm.base_from_tcp, path) | {
        "overrides": {override.code: override.reason for override in facts.overrides},
        "requested": wanted.model_dump(mode="json", exclude_none=True, exclude={"overrides"}),
    }
    data = {"kind": facts.kind, "overrides": content["overrides"]}
    artefact = NewArtefact(ArtefactKind.PLAN, facts.plan_id, facts.made_from, content, {})
    detail = {key: value for key, value in content.items() if key not in ("start_joints_rad", "requested")}
    return Prepared(facts, (artefact,), {"plan": facts.plan_id}, data, detail)
