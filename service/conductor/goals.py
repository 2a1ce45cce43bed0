"""Where a motion is to end, and whether the straight way there can be gone."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, assert_never

import numpy as np
from sqlalchemy.engine import Connection

from robot.arm import ArmState
from robot.frames import Transform, goal_in_base
from robot.path import Path, Way, plan_path
from robot.path_limits import PathLimits
from robot.poses import pose_of, retreat
from robot.refusal import Refusal, RefusalCode
from service.cases import store
from service.cases.records import ArtefactKind
from service.conductor.bodies import Pose, RequestPlan
from service.conductor.device_set import DeviceSet
from service.errors import ErrorCode, ServiceError
from service.images.store import exposure_pose
from vision.handedness import LEAST_NUDGE_MM
from workflow.case import CaseState
from workflow.plans import AIMED, PlanKind
from workflow.verdicts import Verdict

_H12 = frozenset({RefusalCode.KEEP_OUT, RefusalCode.PATH_TOO_LONG})

_PREDICTED = ("predicted_error_95", "detectable_motion")  # of a target; other motions predict neither


@dataclass(frozen=True, slots=True, eq=False)
class Goal:
    """A pose for the guide, and what is predicted there: the error, and what the image after the motion will see."""

    base_from_goal: Transform
    axial: bool
    predicted: Mapping[str, Any]


def goal_of(connection: Connection, case: CaseState, wanted: RequestPlan, arm: ArmState) -> Goal:
    """The goal of a plan of this kind; ServiceError where what it needs is not there."""
    if wanted.kind in AIMED:
        return _at_the_target(connection, case)
    return goal_asked_for(wanted, arm.base_from_tcp)


def goal_asked_for(wanted: RequestPlan, base_from_tcp: Transform) -> Goal:
    """The goal of a plan that a person says, from the pose (4, 4), mm, where the arm is."""
    nothing = dict.fromkeys(_PREDICTED)
    match wanted.kind:
        case PlanKind.APPROACH | PlanKind.CALIBRATION:
            return Goal(_pose(wanted.base_from_goal), False, nothing)
        case PlanKind.NUDGE:
            return Goal(goal_in_base(base_from_tcp, _nudge(wanted.step)), False, nothing)
        case PlanKind.RETREAT:
            return Goal(goal_in_base(base_from_tcp, retreat(wanted.distance_mm or 0.0)), True, nothing)
        case PlanKind.TARGETING | PlanKind.CORRECTIVE:
            raise ValueError(f"the goal of a {wanted.kind} plan is that of its target")
        case _:
            assert_never(wanted.kind)


def goal_at_target(base_from_guide: Transform, targeting: Mapping[str, Any]) -> Goal:
    """The goal of a plan onto a target, from the pose (4, 4), mm, that the arm held during the exposure."""
    base_from_goal = goal_in_base(base_from_guide, np.array(targeting["guide_from_goal"]))
    return Goal(base_from_goal, False, {name: targeting[name] for name in _PREDICTED})


def way_to(goal: Goal, arm: ArmState, devices: DeviceSet) -> Path:
    """The checked path from where the arm is; ServiceError with robot's own code and its verdict (H11, H12)."""
    if devices.room is None:
        raise ServiceError(ErrorCode.DEVICE_UNKNOWN, "the case has no room file: nothing says what to keep out of")
    way = Way(arm.joints_rad, arm.base_from_tcp, goal.base_from_goal, leaving=goal.axial)
    path = plan_path(way, devices.tool, devices.room, PathLimits())
    if isinstance(path, Refusal):
        raise _refused(path)
    return path


def _refused(refusal: Refusal) -> ServiceError:
    """As an interlock's refusal is told and stored."""
    verdict = Verdict(
        code=refusal.code,
        hazard="H12" if refusal.code in _H12 else "H11",
        passed=False,
        measured=refusal.measured,
        limit=refusal.limit,
        unit="",
        message=refusal.message,
    )
    return ServiceError(
        refusal.code,
        refusal.message,
        measured=refusal.measured,
        limit=refusal.limit,
        verdicts=[asdict(verdict)],
    )


def _at_the_target(connection: Connection, case: CaseState) -> Goal:
    """The targeting result, composed with the pose that the arm held during the exposure, not the one it holds now."""
    if case.target is None or case.image is None:
        # The rules refuse the request for what is missing; they need a plan to say so about.
        raise ServiceError(ErrorCode.IMAGE_NOT_REGISTERED, "the case has no target to move to")
    targeting = store.read_artefact(connection, ArtefactKind.TARGET, case.target.id).content["targeting"]
    return goal_at_target(exposure_pose(connection, case.image.id), targeting)


def _nudge(step: Pose | None) -> Transform:
    """A step that can prove handedness; ServiceError NUDGE_TOO_SHORT (H05)."""
    guide_from_goal = _pose(step)
    along_mm = abs(float(guide_from_goal[1, 3]))
    if along_mm < LEAST_NUDGE_MM:
        message = "a nudge goes along the guide's own y, or it proves nothing (mm)"
        raise ServiceError(ErrorCode.NUDGE_TOO_SHORT, message, measured=along_mm, limit=LEAST_NUDGE_MM)
    return guide_from_goal


def _pose(pose: Pose | None) -> Transform:
    if pose is None:
        raise ValueError("the request was validated to have a pose")
    return pose_of(np.array(pose.translation_mm), np.radians(pose.rotation_vector_deg))
