"""The straight line that the TCP is to follow, and how fast."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from robot.frames import Array, Transform, distance_between

_STEP_MM = 2.0  # between samples: the arm's curvature over 2 mm or 0.5 deg is far below its margins
_STEP_RAD = float(np.deg2rad(0.5))


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A straight line with the shortest turn along it.

    Attributes
    ----------
    base_from_start, base_from_goal : (4, 4), mm
    length_mm, angle_rad : float
    """

    base_from_start: Transform
    base_from_goal: Transform
    length_mm: float
    angle_rad: float


@dataclass(frozen=True, slots=True)
class Pace:
    """Trapezoidal pace of a motion along a line."""

    speed_mm_s: float
    acceleration_mm_s2: float
    duration_s: float


def line_between(base_from_start: Transform, base_from_goal: Transform) -> Line:
    """Line between two (4, 4) poses in mm."""
    return Line(base_from_start, base_from_goal, *distance_between(base_from_start, base_from_goal))


def sample_line(line: Line) -> Array:
    """Evenly spaced poses on a line, both ends included.

    Returns
    -------
    (samples, 4, 4), mm
        base_from_sample; at least three, at most 2 mm and 0.5 deg apart.
    """
    count = 1 + max(2, int(np.ceil(line.length_mm / _STEP_MM)), int(np.ceil(line.angle_rad / _STEP_RAD)))
    shares = np.linspace(0.0, 1.0, count)
    start, goal = line.base_from_start, line.base_from_goal
    turn = Rotation.from_matrix(start[:3, :3].T @ goal[:3, :3]).as_rotvec()
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = start[:3, :3] @ Rotation.from_rotvec(shares[:, None] * turn).as_matrix()
    poses[:, :3, 3] = start[:3, 3] + shares[:, None] * (goal[:3, 3] - start[:3, 3])
    return poses


def pace_of(line: Line, speed_mm_s: float, acceleration_mm_s2: float, turn_lever_mm: float) -> Pace:
    """Pace of the controller along a line, for one commanded speed.

    Parameters
    ----------
    turn_lever_mm : float
        Length that the controller counts for one radian of turn: the longer of the line and the turn's share decides
        how long a linear move takes.

    Notes
    -----
    The duration is that of a trapezoid, or of a triangle where the way is too short to reach the speed.
    """
    way_mm = max(line.length_mm, line.angle_rad * turn_lever_mm)
    ramp_mm = speed_mm_s**2 / acceleration_mm_s2
    if way_mm >= ramp_mm:
        duration_s = way_mm / speed_mm_s + speed_mm_s / acceleration_mm_s2
    else:
        duration_s = 2.0 * float(np.sqrt(way_mm / acceleration_mm_s2))
    return Pace(speed_mm_s, acceleration_mm_s2, duration_s)
