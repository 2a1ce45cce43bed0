"""Limits of the interlocks, each with its unit and origin."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Limits:
    """Passed in with every question; the service takes them from its settings."""

    # Times. Window and permit: the state machine; feedback and heartbeat: the guard's own limits.
    exposure_window_s: float = 120.0
    permit_life_s: float = 30.0
    feedback_age_s: float = 0.1
    heartbeat_age_s: float = 0.2
    # Own choice: slow readings (files, controller settings, lease) are read anew for each question.
    record_age_s: float = 2.0
    # Own choice: a breathing patient on a table is not the one of a quarter of an hour ago.
    verification_age_s: float = 900.0
    # H03, own choice: between the image and the move nothing sees a C-arm that is turned.
    image_age_s: float = 1800.0
    # How far a surgeon may override it: own choice, twice as long.
    image_age_hard_s: float = 3600.0
    # H04, at the TCP.
    unaccounted_mm: float = 0.05
    unaccounted_rad: float = math.radians(0.02)
    # Joint tolerance of a permit: the angle of H04.
    permit_joint_rad: float = math.radians(0.02)
    # H29, alarm limits of the pose that is watched while inserting.
    drift_mm: float = 0.3
    drift_rad: float = math.radians(0.1)
    # H10, the coarse check: this difference is seen through the nominal kinematics, from which a calibrated arm is off
    # by 1 to 2 mm, as in the path check. The exact one is the guard's: it reads the controller's TCP before it moves.
    tcp_difference_mm: float = 5.0
    tcp_difference_rad: float = math.radians(1.0)
    payload_difference_kg: float = 0.05
    # Arrival: the guard's own tolerance.
    arrival_mm: float = 0.1
    arrival_rad: float = math.radians(0.05)
    # The verification: error and its 95 % bound together.
    angle_error_rad: float = math.radians(1.0)
    position_error_mm: float = 1.5
    # H07, predicted at the target (95 %): what a registration's own gate allows for its reference depth. A surgeon may
    # override it up to the limit of the verification, beyond which no verification could pass.
    aim_angle_rad: float = math.radians(0.25)
    aim_position_mm: float = 0.5
    # H03, of a chi-square: told by the evaluation that measured it; where none tells it nothing but 0 passes.
    motion_chi_square: float = 0.0
    # H34, at the target's depth: half of what must be seen across the beam; along it the scale tells less.
    anatomy_across_mm: float = 0.5
    anatomy_along_mm: float = 2.0
    # H05 to H07: what a registration must at least show; the finer gates are vision's.
    plate_balls: int = 40  # a tenth of the reference plate
    scale_error: float = 0.1  # relative: a C-arm file that is off by more is another C-arm's
    fiducials: int = 12  # of the guide
    residual_rms_px: float = 1.0
    # H11, those of the path check itself.
    joint_margin_rad: float = math.radians(5.0)
    smallest_singular_value: float = 0.05  # of the Jacobian at the flange, lengths in units of the reach
    # H12: what one held motion near the patient may be. The clearance is the least that a room file may ask for.
    clearance_mm: float = 2.0
    path_length_mm: float = 150.0
    path_angle_rad: float = math.radians(35.0)
    speed_mm_s: float = 20.0
    speed_rad_s: float = math.radians(5.0)
    acceleration_mm_s2: float = 50.0
    # H09, edges of plausibility.
    joint_rad: float = 2.0 * math.pi
    evaluation_angle_rad: float = math.radians(45.0)  # the guide's z lies within 45 deg of the ray
    evaluation_position_mm: float = 150.0  # the guide's field
