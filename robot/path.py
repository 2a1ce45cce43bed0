"""Check of a straight-line TCP path before it is approved (H11)."""

from dataclasses import dataclass

import numpy as np

from robot.frames import Array, Transform
from robot.refusal import Refusal

SPEED_CAP_MM_S = 20.0  # H12
TURN_SPEED_CAP_RAD_S = float(np.deg2rad(5.0))  # H12


@dataclass(frozen=True, slots=True)
class PathLimits:
    """What a path must keep; defaults for a UR5 near a patient."""

    joint_range_rad: float = 2.0 * np.pi  # either way, every joint of a UR5
    joint_margin_rad: float = float(np.deg2rad(5.0))
    joint_speed_rad_s: float = float(np.deg2rad(30.0))
    smallest_singular_value: float = 0.05  # of the Jacobian with lengths in units of the reach
    reach_mm: float = 850.0
    length_mm: float = 600.0
    model_offset_mm: float = 5.0  # nominal kinematics against the controller's pose at the start
    model_turn_rad: float = float(np.deg2rad(1.0))
    speed_mm_s: float = SPEED_CAP_MM_S
    turn_speed_rad_s: float = TURN_SPEED_CAP_RAD_S
    acceleration_mm_s2: float = 50.0


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
    raise NotImplementedError
