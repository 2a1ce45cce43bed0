"""Check of a straight-line TCP path before it is approved (H11, H12)."""

from dataclasses import dataclass

import numpy as np

from robot.caps import ACCELERATION_CAP_MM_S2, SPEED_CAP_MM_S, TURN_SPEED_CAP_RAD_S
from robot.frames import Array, Transform, check_rigid
from robot.kinematics import D_MM, base_from_flange, manipulability, solve_joints
from robot.line import Line, Pace, line_between, pace_of, sample_line
from robot.path_checks import (
    refuse_extent,
    refuse_margins,
    refuse_model,
    refuse_nearness,
    refuse_singular,
    refuse_steps,
)
from robot.path_limits import PathLimits
from robot.refusal import Refusal, RefusalCode
from robot.room_shapes import RoomShapes
from robot.sweep import Sweep, sweep
from robot.tool import Tool

_SHOULDER_IN_BASE_MM = np.array([0.0, 0.0, D_MM[0]])


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """A way that is asked for.

    Attributes
    ----------
    joints_rad : (6,)
        Joints now.
    base_from_start, base_from_goal : (4, 4), mm
        TCP poses as the controller reports them.
    leaving : bool
        Whether it only leads away from the patient. Such a way may begin nearer to a shape than the room's clearance,
        but never comes nearer: an arm that stands too near must be able to leave.
    """

    joints_rad: Array
    base_from_start: Transform
    base_from_goal: Transform
    leaving: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """A path that keeps its limits.

    Attributes
    ----------
    base_from_goal : (4, 4), mm
    start_joints_rad : (6,)
        What a permit binds (H04).
    joints_rad : (samples, 6)
        Windings kept from the start.
    base_from_samples : (samples, 4, 4), mm
    length_mm, angle_rad : float
    speed_mm_s, acceleration_mm_s2, duration_s : float
        Along the line, so that neither cap is passed.
    joint_margin_rad, smallest_singular_value : float
        The smallest on the path.
    swept : Sweep
        Clearances from the shapes of the room.
    clearance_mm, needed_mm : float
        Where the path comes nearest to its limit, and the limit there.
    """

    base_from_goal: Transform
    start_joints_rad: Array
    joints_rad: Array
    base_from_samples: Array
    length_mm: float
    angle_rad: float
    speed_mm_s: float
    acceleration_mm_s2: float
    duration_s: float
    joint_margin_rad: float
    smallest_singular_value: float
    swept: Sweep
    clearance_mm: float
    needed_mm: float


def plan_path(way: Way, tool: Tool, room: RoomShapes, limits: PathLimits) -> Path | Refusal:
    """Check the straight line from the arm's pose to a goal.

    Returns
    -------
    Path or Refusal
        The refusal says where on the line, and how near the limit was.

    Raises
    ------
    ValueError
        If a transform is not rigid or a number not finite.
    """
    start_joints = _check_joints(way.joints_rad)
    line = line_between(check_rigid(way.base_from_start), check_rigid(way.base_from_goal))
    nominal = base_from_flange(start_joints) @ tool.flange_from_guide
    refusal = refuse_model(line, nominal, limits) or refuse_extent(line, limits)
    if refusal is not None:
        return refusal
    # The nominal arm's error changes little along the line: carry it over from the start.
    nominal_from_base = nominal @ np.linalg.inv(line.base_from_start)
    samples = sample_line(line)
    joints = _follow(nominal_from_base @ samples @ np.linalg.inv(tool.flange_from_guide), start_joints, limits)
    if isinstance(joints, Refusal):
        return joints
    pace = pace_of(line, _speed(limits), min(limits.acceleration_mm_s2, ACCELERATION_CAP_MM_S2), limits.turn_lever_mm)
    refusal = _refuse_joints(line, pace, joints, limits)
    if refusal is not None:
        return refusal
    swept = sweep(samples, joints, tool.flange_from_guide, tool.envelope, room)
    needed_mm = _needed(swept, room.clearance_mm, way.leaving)
    return refuse_nearness(line, swept, needed_mm) or _path(line, pace, joints, (samples, swept, needed_mm), limits)


def _check_joints(joints_rad: Array) -> Array:
    joints = np.asarray(joints_rad, dtype=np.float64)
    if joints.shape != (6,) or not np.isfinite(joints).all():
        raise ValueError("an arm has six finite joint angles")
    return joints


def _follow(base_from_flanges: Array, start_joints_rad: Array, limits: PathLimits) -> Array | Refusal:
    """Joints along (samples, 4, 4) flange poses, each found from its neighbour, or where that ends."""
    followed = [start_joints_rad]
    last = len(base_from_flanges) - 1
    for index, pose in enumerate(base_from_flanges):
        joints = solve_joints(pose, followed[-1])
        if joints is None:
            reach_mm = float(np.linalg.norm(pose[:3, 3] - _SHOULDER_IN_BASE_MM))
            message = f"no joints reach sample {index} of {last}; its distance from the shoulder (mm)"
            return Refusal(RefusalCode.GOAL_UNREACHABLE, message, reach_mm, limits.reach_mm)
        followed.append(joints)
    return np.array(followed[1:])


def _refuse_joints(line: Line, pace: Pace, joints_rad: Array, limits: PathLimits) -> Refusal | None:
    return (
        refuse_margins(_margins(joints_rad, limits), joints_rad, limits)
        or refuse_singular(_singular(joints_rad), joints_rad, limits)
        or refuse_steps(line, pace, joints_rad, limits)
    )


def _margins(joints_rad: Array, limits: PathLimits) -> Array:
    return np.asarray(limits.joint_range_rad - np.abs(joints_rad).max(axis=1))


def _singular(joints_rad: Array) -> Array:
    return np.array([manipulability(joints).smallest_singular_value for joints in joints_rad])


def _needed(swept: Sweep, clearance_mm: float, leaving: bool) -> Array:
    """Clearance that each of the (parts, shapes) needs."""
    asked = np.full(swept.start_mm.shape, clearance_mm)
    return np.minimum(asked, swept.start_mm) if leaving else asked


def _path(line: Line, pace: Pace, joints_rad: Array, along: tuple[Array, Sweep, Array], limits: PathLimits) -> Path:
    samples, swept, needed_mm = along
    nearest, limit_mm = swept.worst_against(needed_mm)
    return Path(
        base_from_goal=line.base_from_goal,
        start_joints_rad=joints_rad[0],
        joints_rad=joints_rad,
        base_from_samples=samples,
        length_mm=line.length_mm,
        angle_rad=line.angle_rad,
        speed_mm_s=pace.speed_mm_s,
        acceleration_mm_s2=pace.acceleration_mm_s2,
        duration_s=pace.duration_s,
        joint_margin_rad=float(_margins(joints_rad, limits).min()),
        smallest_singular_value=float(_singular(joints_rad).min()),
        swept=swept,
        clearance_mm=nearest.clearance_mm,
        needed_mm=limit_mm,
    )


def _speed(limits: PathLimits) -> float:
    """Speed along the line at which neither cap is passed, mm/s."""
    speed_mm_s = min(limits.speed_mm_s, SPEED_CAP_MM_S)
    turn_speed_rad_s = min(limits.turn_speed_rad_s, TURN_SPEED_CAP_RAD_S)
    return min(speed_mm_s, turn_speed_rad_s * limits.turn_lever_mm)
