"""What a path must keep."""

from dataclasses import dataclass

import numpy as np

from robot.caps import (
    ACCELERATION_CAP_MM_S2,
    ANGLE_CAP_RAD,
    LENGTH_CAP_MM,
    SPEED_CAP_MM_S,
    TURN_SPEED_CAP_RAD_S,
)


@dataclass(frozen=True, slots=True)
class PathLimits:
    """What a path must keep; defaults for a UR5 near a patient."""

    joint_range_rad: float = 2.0 * np.pi  # either way, every joint of a UR5
    joint_margin_rad: float = float(np.deg2rad(5.0))
    joint_jump_rad: float = 0.2  # between neighbouring samples: more is another branch
    joint_speed_rad_s: float = float(np.deg2rad(30.0))
    smallest_singular_value: float = 0.05  # dimensionless; 9 deg from the wrist's singularity, 15 from the elbow's
    reach_mm: float = 850.0  # shoulder to flange
    length_mm: float = LENGTH_CAP_MM
    angle_rad: float = ANGLE_CAP_RAD
    model_offset_mm: float = 5.0  # nominal kinematics against the controller's pose: 1 to 2 mm on a calibrated arm
    model_turn_rad: float = float(np.deg2rad(1.0))
    speed_mm_s: float = SPEED_CAP_MM_S
    turn_speed_rad_s: float = TURN_SPEED_CAP_RAD_S
    acceleration_mm_s2: float = ACCELERATION_CAP_MM_S2
    # What the controller counts for a radian of turn in a linear move: not published, to be measured on each arm; the
    # guard stops a motion whose measured turn passes the cap.
    turn_lever_mm: float = 250.0
