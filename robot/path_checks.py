"""The checks of a path, one limit each: None, or a refusal that says where on the path and how near the limit."""

import numpy as np

from robot.frames import Array, Transform, distance_between
from robot.kinematics import manipulability
from robot.line import Line, Pace
from robot.path_limits import PathLimits
from robot.refusal import Refusal, RefusalCode
from robot.sweep import Sweep


def refuse_model(line: Line, nominal: Transform, limits: PathLimits) -> Refusal | None:
    """The controller's pose must be what its joints and the calibration say (H10)."""
    offset_mm, turn_rad = distance_between(nominal, line.base_from_start)
    if offset_mm <= limits.model_offset_mm and turn_rad <= limits.model_turn_rad:
        return None
    message = (
        f"the controller's TCP is {offset_mm:.2f} mm and {np.rad2deg(turn_rad):.2f} deg from where its joints and the"
        " TCP calibration put the guide (mm)"
    )
    return Refusal(RefusalCode.MODEL_MISMATCH, message, offset_mm, limits.model_offset_mm)


def refuse_extent(line: Line, limits: PathLimits) -> Refusal | None:
    """One held motion goes only so far (H12)."""
    if not line.length_mm <= limits.length_mm:
        return Refusal(RefusalCode.PATH_TOO_LONG, "length of the path (mm)", line.length_mm, limits.length_mm)
    if not line.angle_rad <= limits.angle_rad:
        return Refusal(RefusalCode.PATH_TOO_LONG, "turn along the path (rad)", line.angle_rad, limits.angle_rad)
    return None


def refuse_margins(margins_rad: Array, joints_rad: Array, limits: PathLimits) -> Refusal | None:
    """Every joint keeps its distance from its limits (H11)."""
    index = int(margins_rad.argmin())
    if margins_rad[index] >= limits.joint_margin_rad:
        return None
    joint = int(np.abs(joints_rad[index]).argmax()) + 1
    message = f"joint {joint} comes too near its limit at sample {index} of {len(joints_rad) - 1} (rad left)"
    return Refusal(RefusalCode.JOINT_LIMIT, message, float(margins_rad[index]), limits.joint_margin_rad)


def refuse_singular(singular: Array, joints_rad: Array, limits: PathLimits) -> Refusal | None:
    """The arm stays away from its singularities (H11)."""
    index = int(singular.argmin())
    if singular[index] >= limits.smallest_singular_value:
        return None
    name = manipulability(joints_rad[index]).nearest
    message = f"near the singularity of the {name} at sample {index} of {len(singular) - 1} (smallest singular value)"
    return Refusal(RefusalCode.NEAR_SINGULARITY, message, float(singular[index]), limits.smallest_singular_value)


def refuse_steps(line: Line, pace: Pace, joints_rad: Array, limits: PathLimits) -> Refusal | None:
    """Steps between samples: none so large that it changes the branch, none faster than the joints may turn."""
    steps_rad = np.abs(np.diff(joints_rad, axis=0)).max(axis=1)
    index = int(steps_rad.argmax())
    where = f"at sample {index + 1} of {len(steps_rad)}"
    if not steps_rad[index] <= limits.joint_jump_rad:
        message = f"the joints jump to another branch {where} (rad)"
        return Refusal(RefusalCode.JOINT_JUMP, message, float(steps_rad[index]), limits.joint_jump_rad)
    step_mm = max(line.length_mm, line.angle_rad * limits.turn_lever_mm) / len(steps_rad)
    speed_rad_s = float(steps_rad[index] * pace.speed_mm_s / step_mm) if step_mm > 0.0 else 0.0
    if not speed_rad_s <= limits.joint_speed_rad_s:
        message = f"a joint would have to turn too fast {where} (rad/s)"
        return Refusal(RefusalCode.JOINT_SPEED, message, speed_rad_s, limits.joint_speed_rad_s)
    return None


def refuse_nearness(line: Line, swept: Sweep, needed_mm: Array) -> Refusal | None:
    """No part of the arm comes nearer to a shape than the (parts, shapes) need (H12)."""
    worst, limit_mm = swept.worst_against(needed_mm)
    if worst.clearance_mm >= limit_mm:
        return None
    segments = len(swept.clearances_mm)
    begin_mm, end_mm = (line.length_mm * step / segments for step in (worst.segment, worst.segment + 1))
    message = (
        f"the arm's {worst.part} comes too near the room's {worst.shape} between samples {worst.segment} and"
        f" {worst.segment + 1} of {segments}, {begin_mm:.0f} to {end_mm:.0f} mm along the line (mm)"
    )
    return Refusal(RefusalCode.KEEP_OUT, message, worst.clearance_mm, limit_mm)
