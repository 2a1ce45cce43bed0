"""Check of a straight-line TCP path before it is approved (H11)."""

from dataclasses import dataclass

import numpy as np

from robot.frames import Array, Transform, check_rigid, distance_between
from robot.kinematics import D_MM, base_from_flange, manipulability, solve_joints
from robot.line import Line, Pace, line_between, pace_of, sample_line
from robot.refusal import Refusal, RefusalCode

SPEED_CAP_MM_S = 20.0  # H12
TURN_SPEED_CAP_RAD_S = float(np.deg2rad(5.0))  # H12
_SHOULDER_IN_BASE_MM = np.array([0.0, 0.0, D_MM[0]])


@dataclass(frozen=True, slots=True)
class PathLimits:
    """What a path must keep; defaults for a UR5 near a patient."""

    joint_range_rad: float = 2.0 * np.pi  # either way, every joint of a UR5
    joint_margin_rad: float = float(np.deg2rad(5.0))
    joint_jump_rad: float = 0.2  # between neighbouring samples: more is another branch
    joint_speed_rad_s: float = float(np.deg2rad(30.0))
    smallest_singular_value: float = 0.05  # dimensionless; 9 deg from the wrist's singularity, 15 from the elbow's
    reach_mm: float = 850.0  # shoulder to flange
    length_mm: float = 600.0
    angle_rad: float = float(np.deg2rad(120.0))  # the shortest turn is ambiguous at 180
    model_offset_mm: float = 5.0  # nominal kinematics against the controller's pose: 1 to 2 mm on a calibrated arm
    model_turn_rad: float = float(np.deg2rad(1.0))
    speed_mm_s: float = SPEED_CAP_MM_S
    turn_speed_rad_s: float = TURN_SPEED_CAP_RAD_S
    acceleration_mm_s2: float = 50.0
    # What the controller counts for a radian of turn in a linear move: not published, to be measured on each arm; the
    # guard stops a motion whose measured turn passes the cap.
    turn_lever_mm: float = 250.0


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
    length_mm, angle_rad : float
    speed_mm_s, acceleration_mm_s2, duration_s : float
        Along the line, so that neither cap is passed.
    joint_margin_rad, smallest_singular_value : float
        The smallest on the path.
    """

    base_from_goal: Transform
    start_joints_rad: Array
    joints_rad: Array
    length_mm: float
    angle_rad: float
    speed_mm_s: float
    acceleration_mm_s2: float
    duration_s: float
    joint_margin_rad: float
    smallest_singular_value: float


def plan_path(
    joints_rad: Array,
    base_from_start: Transform,
    base_from_goal: Transform,
    flange_from_guide: Transform,
    limits: PathLimits,
) -> Path | Refusal:
    """Check the straight line from the arm's pose to a goal.

    Parameters
    ----------
    joints_rad : (6,)
        Joints now.
    base_from_start, base_from_goal : (4, 4), mm
        TCP poses as the controller reports them.
    flange_from_guide : (4, 4), mm
        TCP calibration.

    Returns
    -------
    Path or Refusal
        The refusal says at which sample of the line, and how near the limit was.

    Raises
    ------
    ValueError
        If a transform is not rigid or a number not finite.
    """
    start_joints = _check_joints(joints_rad)
    line = line_between(check_rigid(base_from_start), check_rigid(base_from_goal))
    nominal = base_from_flange(start_joints) @ check_rigid(flange_from_guide)
    refusal = _refuse_model(line, nominal, limits) or _refuse_extent(line, limits)
    if refusal is not None:
        return refusal
    # The nominal arm's error changes little along the line: carry it over from the start.
    nominal_from_base = nominal @ np.linalg.inv(line.base_from_start)
    base_from_flanges = nominal_from_base @ sample_line(line) @ np.linalg.inv(flange_from_guide)
    followed = _follow(base_from_flanges, start_joints, limits)
    return followed if isinstance(followed, Refusal) else _judge(line, followed, limits)


def _check_joints(joints_rad: Array) -> Array:
    joints = np.asarray(joints_rad, dtype=np.float64)
    if joints.shape != (6,) or not np.isfinite(joints).all():
        raise ValueError("an arm has six finite joint angles")
    return joints


def _refuse_model(line: Line, nominal: Transform, limits: PathLimits) -> Refusal | None:
    """The controller's pose must be what its joints and the calibration say (H10)."""
    offset_mm, turn_rad = distance_between(nominal, line.base_from_start)
    if offset_mm <= limits.model_offset_mm and turn_rad <= limits.model_turn_rad:
        return None
    message = (
        f"the controller's TCP is {offset_mm:.2f} mm and {np.rad2deg(turn_rad):.2f} deg from where its joints and the"
        " TCP calibration put the guide (mm)"
    )
    return Refusal(RefusalCode.MODEL_MISMATCH, message, offset_mm, limits.model_offset_mm)


def _refuse_extent(line: Line, limits: PathLimits) -> Refusal | None:
    if line.length_mm > limits.length_mm:
        return Refusal(RefusalCode.PATH_TOO_LONG, "length of the path (mm)", line.length_mm, limits.length_mm)
    if line.angle_rad > limits.angle_rad:
        return Refusal(RefusalCode.PATH_TOO_LONG, "turn along the path (rad)", line.angle_rad, limits.angle_rad)
    return None


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


def _judge(line: Line, joints_rad: Array, limits: PathLimits) -> Path | Refusal:
    """Path of (samples, 6) joints, or the first limit that it does not keep."""
    pace = pace_of(line, _speed(limits), limits.acceleration_mm_s2, limits.turn_lever_mm)
    singular = np.array([manipulability(joints).smallest_singular_value for joints in joints_rad])
    margins = limits.joint_range_rad - np.abs(joints_rad).max(axis=1)
    refusal = (
        _refuse_margins(margins, joints_rad, limits)
        or _refuse_singular(singular, joints_rad, limits)
        or _refuse_steps(line, pace, joints_rad, limits)
    )
    if refusal is not None:
        return refusal
    return Path(
        base_from_goal=line.base_from_goal,
        start_joints_rad=joints_rad[0],
        joints_rad=joints_rad,
        length_mm=line.length_mm,
        angle_rad=line.angle_rad,
        speed_mm_s=pace.speed_mm_s,
        acceleration_mm_s2=pace.acceleration_mm_s2,
        duration_s=pace.duration_s,
        joint_margin_rad=float(margins.min()),
        smallest_singular_value=float(singular.min()),
    )


def _speed(limits: PathLimits) -> float:
    """Speed along the line at which neither cap is passed, mm/s."""
    speed_mm_s = min(limits.speed_mm_s, SPEED_CAP_MM_S)
    turn_speed_rad_s = min(limits.turn_speed_rad_s, TURN_SPEED_CAP_RAD_S)
    return min(speed_mm_s, turn_speed_rad_s * limits.turn_lever_mm)


def _refuse_margins(margins_rad: Array, joints_rad: Array, limits: PathLimits) -> Refusal | None:
    index = int(margins_rad.argmin())
    if margins_rad[index] >= limits.joint_margin_rad:
        return None
    joint = int(np.abs(joints_rad[index]).argmax()) + 1
    message = f"joint {joint} comes too near its limit at sample {index} of {len(joints_rad) - 1} (rad left)"
    return Refusal(RefusalCode.JOINT_LIMIT, message, float(margins_rad[index]), limits.joint_margin_rad)


def _refuse_singular(singular: Array, joints_rad: Array, limits: PathLimits) -> Refusal | None:
    index = int(singular.argmin())
    if singular[index] >= limits.smallest_singular_value:
        return None
    name = manipulability(joints_rad[index]).nearest
    message = f"near the singularity of the {name} at sample {index} of {len(singular) - 1} (smallest singular value)"
    return Refusal(RefusalCode.NEAR_SINGULARITY, message, float(singular[index]), limits.smallest_singular_value)


def _refuse_steps(line: Line, pace: Pace, joints_rad: Array, limits: PathLimits) -> Refusal | None:
    """Steps between samples: none so large that it changes the branch, none faster than the joints may turn."""
    steps_rad = np.abs(np.diff(joints_rad, axis=0)).max(axis=1)
    index = int(steps_rad.argmax())
    where = f"at sample {index + 1} of {len(steps_rad)}"
    if steps_rad[index] > limits.joint_jump_rad:
        message = f"the joints jump to another branch {where} (rad)"
        return Refusal(RefusalCode.JOINT_JUMP, message, float(steps_rad[index]), limits.joint_jump_rad)
    step_mm = max(line.length_mm, line.angle_rad * limits.turn_lever_mm) / len(steps_rad)
    speed_rad_s = float(steps_rad[index] * pace.speed_mm_s / step_mm) if step_mm > 0.0 else 0.0
    if speed_rad_s > limits.joint_speed_rad_s:
        message = f"a joint would have to turn too fast {where} (rad/s)"
        return Refusal(RefusalCode.JOINT_SPEED, message, speed_rad_s, limits.joint_speed_rad_s)
    return None
