"""A plan as it is recorded."""

import math
from typing import Any

from robot.frames import Transform
from robot.path import Path
from service.conductor.goals import Goal
from workflow.plans import PlanKind


def plan_content(kind: PlanKind, goal: Goal, base_from_start: Transform, path: Path) -> dict[str, Any]:
    """What a plan's row holds of its goal and of its checked path, from the pose `base_from_start` (4, 4), mm."""
    return {
        "kind": kind.value,
        "axial": goal.axial,
        "base_from_goal": path.base_from_goal.tolist(),
        "base_from_start": base_from_start.tolist(),
        "start_joints_rad": path.start_joints_rad.tolist(),
        "length_mm": path.length_mm,
        "rotation_deg": math.degrees(path.angle_rad),
        "speed_mm_s": path.speed_mm_s,
        "acceleration_mm_s2": path.acceleration_mm_s2,
        "duration_s": path.duration_s,
        "joint_margin_deg": math.degrees(path.joint_margin_rad),
        "smallest_singular_value": path.smallest_singular_value,
        "clearance_mm": path.clearance_mm,
        "clearance_needed_mm": path.needed_mm,
        "preview": _preview(path),
        **goal.predicted,
    }


def _preview(path: Path) -> list[dict[str, Any]]:
    """The pieces of the path in order: where each ends, and what it comes nearest to on its way."""
    ends_mm = path.base_from_samples[1:, :3, 3].tolist()
    nearest = (path.swept.on_segment(segment) for segment in range(len(ends_mm)))
    return [
        {"to_mm": end_mm, "clearance_mm": one.clearance_mm, "part": one.part, "shape": one.shape}
        for end_mm, one in zip(ends_mm, nearest, strict=True)
    ]
