"""Computes a case anew, each result from those before it as they come out now, and compares it with the record.

So a result that was altered in the record is named alone, and a new version is tried on the whole way of a case.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, assert_never

import numpy as np

from robot.frames import motion_between
from robot.path import Way, plan_path
from robot.path_limits import PathLimits
from robot.refusal import Refusal
from robot.room_shapes import read_room
from robot.tool import Tool, read_tool
from service import vision_jobs
from service.conductor.bodies import RequestPlan
from service.conductor.goals import Goal, goal_asked_for, goal_at_target
from service.conductor.plan_content import plan_content
from service.devices.store import DeviceKind
from service.errors import ServiceError
from service.motion_errors import motion_errors
from service.replay.comparing import differences
from service.replay.inputs import (
    CaseInput,
    CaseReplay,
    Difference,
    Evaluated,
    Image,
    Json,
    Planned,
    Registered,
    Step,
    Targeted,
)
from service.settings import ArmAccuracy
from workflow.plans import PlanKind

_Px = tuple[float, float]
_SAID = ("requested", "overrides")  # by people with a plan: no results


def replay(case: CaseInput) -> CaseReplay:
    """Compute every result of a case anew."""
    anew = _Anew(case)
    found = [difference for step in case.steps for difference in anew.take(step)]
    return CaseReplay(
        case_id=case.case_id,
        registrations=anew.counted[Registered],
        targets=anew.counted[Targeted],
        plans=anew.counted[Planned],
        evaluations=anew.counted[Evaluated],
        differences=(*case.faults, *found),
    )


class _NotComputedError(Exception):
    """What a result was made from did not come out this time, or is not in the record."""


@dataclass(slots=True)
class _Anew:
    """The results that came out so far, by id."""

    case: CaseInput
    registrations: dict[str, Json] = field(default_factory=dict)
    targets: dict[str, Json] = field(default_factory=dict)
    nudged: bool = False
    counted: dict[type, int] = field(
        default_factory=lambda: dict.fromkeys((Registered, Targeted, Planned, Evaluated), 0)
    )

    def take(self, step: Step) -> Iterator[Difference]:
        """Compute one result; what of it is not as recorded."""
        self.counted[type(step)] += 1
        try:
            yield from self._compare(step)
        except (_NotComputedError, ServiceError, ValueError, KeyError) as error:
            # Whatever an altered record leads a computation to is a difference, not the end of the replay.
            yield Difference(step.where, "", "a result", f"not to be computed: {error}")

    def _compare(self, step: Step) -> list[Difference]:
        match step:
            case Registered():
                return self._keep(step, self._register(step))
            case Targeted():
                self.targets[step.id] = targeted = self._target(step)
                return _compared(step.where, step.recorded["targeting"], targeted)
            case Planned():
                return _compared(step.where, step.recorded, self._plan(step))
            case Evaluated():
                return self._evaluate(step)
            case _:
                assert_never(step)

    def _keep(self, step: Registered, result: Json) -> list[Difference]:
        if step.id is not None and result["status"] == "registered":
            self.registrations[step.id] = result
        return _compared(step.where, step.recorded, result)

    def _register(self, step: Registered) -> Json:
        guide, carm = (self._device(step, kind) for kind in (DeviceKind.GUIDE, DeviceKind.CARM))
        image, first_id = self._image(step).content, step.first_image_id
        if first_id is None:
            return vision_jobs.register(image, guide, carm, self._proved(step))
        moved = motion_between(self._pose(first_id), self._pose(step.image_id)).tolist()
        first = self.case.images[first_id].content
        result = vision_jobs.handedness(first, image, guide, carm, moved, self._errors(step))
        if result["status"] == "registered":
            self.nudged = True
            result["nudge"] |= {"first_image_id": first_id}
        return result

    def _proved(self, step: Registered | None) -> bool:
        """Whether a nudge had proved by then that nothing mirrors: as the result says, or as one before it did."""
        return self.nudged or (step is not None and step.recorded.get("handedness_by") == "nudge")

    def _target(self, step: Targeted) -> Json:
        registration = _came_out(self.registrations, step.registration_id)
        return vision_jobs.target(registration, _pixel(step.recorded), _depth_mm(step.recorded), self._errors(step))

    def _plan(self, step: Planned) -> Json:
        recorded = step.recorded
        base_from_start = np.array(recorded["base_from_start"])
        goal = self._goal(step, base_from_start)
        way = Way(np.array(recorded["start_joints_rad"]), base_from_start, goal.base_from_goal, leaving=goal.axial)
        room = read_room(self._device(step, DeviceKind.ROOM))
        path = plan_path(way, self._tool(step), room, PathLimits())
        if isinstance(path, Refusal):
            raise _NotComputedError(f"{path.code}: {path.message}")
        said = {key: recorded[key] for key in _SAID if key in recorded}
        return plan_content(PlanKind(recorded["kind"]), goal, base_from_start, path) | said

    def _goal(self, step: Planned, base_from_start: Any) -> Goal:
        recorded = step.recorded
        if step.target_id is not None and step.image_id is not None:
            return goal_at_target(self._pose(step.image_id), _came_out(self.targets, step.target_id))
        if "requested" in recorded:
            return goal_asked_for(RequestPlan.model_validate(recorded["requested"]), base_from_start)
        # Recorded before what a person asked for was: the goal is then all that is known of it.
        predicted = {"predicted_error_95": None, "detectable_motion": None}
        return Goal(np.array(recorded["base_from_goal"]), recorded["axial"], predicted)

    def _evaluate(self, step: Evaluated) -> list[Difference]:
        target = self._target_step(step.target_id)
        guide, carm = (self._device(step, kind) for kind in (DeviceKind.GUIDE, DeviceKind.CARM))
        before = {
            "image": self.case.images[target.image_id].content,
            "registration": _came_out(self.registrations, target.registration_id),
            "before_from_after": motion_between(self._pose(target.image_id), self._pose(step.image_id)).tolist(),
            "errors": self._errors(step),
            "handedness_proved": self._proved(step.registration),
        }
        content, pixel, depth_mm = self._image(step).content, _pixel(target.recorded), _depth_mm(target.recorded)
        result = vision_jobs.evaluate(content, guide, carm, pixel, depth_mm, before)
        found = [] if step.registration is None else self._keep(step.registration, result.pop("registration", result))
        return [*found, *_compared(step.where, step.recorded, result)]

    def _image(self, step: Registered | Evaluated) -> Image:
        return self.case.images[step.image_id]

    def _target_step(self, target_id: str) -> Targeted:
        for step in self.case.steps:
            if isinstance(step, Targeted) and step.id == target_id:
                return step
        raise _NotComputedError(f"target {target_id} is not in the record")

    def _pose(self, image_id: str) -> Any:
        pose = self.case.images[image_id].base_from_tcp
        if pose is None:
            raise _NotComputedError(f"the arm's pose during the exposure of image {image_id} is not in the record")
        return np.array(pose)

    def _device(self, step: Step, kind: DeviceKind) -> bytes:
        return self.case.devices[step.devices[kind]]

    def _tool(self, step: Step) -> Tool:
        return read_tool(self._device(step, DeviceKind.TCP))

    def _errors(self, step: Step) -> Json:
        if self.case.settings is None:
            raise _NotComputedError("the settings are not in the record")
        accuracy = ArmAccuracy.model_validate(json.loads(self.case.settings)["arm_accuracy"])
        return motion_errors(accuracy, self._tool(step))


def _came_out(results: Mapping[str, Json], result_id: str) -> Json:
    result = results.get(result_id)
    if result is None or result["status"] == "refused":
        raise _NotComputedError(f"{result_id}, which it is made from, did not come out")
    return result


def _compared(where: str, recorded: Json, result: Json) -> list[Difference]:
    """The differences; of refusals by what was measured, for their sentence may be said better one day."""
    statuses = recorded.get("status"), result.get("status")
    if "refused" not in statuses:
        return differences(where, recorded, result)
    if statuses[0] != statuses[1]:
        return [Difference(where, "", _outcome(recorded), _outcome(result))]
    return differences(where, _measured(recorded), _measured(result))


def _measured(refusal: Json) -> Json:
    return {key: value for key, value in refusal["reason"].items() if key != "message"}


def _outcome(result: Json) -> str:
    return f"refused: {result['reason']['code']}" if result.get("status") == "refused" else "a result"


def _pixel(target: Json) -> _Px:
    u_px, v_px = target["raw_px"]
    return float(u_px), float(v_px)


def _depth_mm(target: Json) -> float:
    return float(target["depth_mm"])
