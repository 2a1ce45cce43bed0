"""What must hold before a motion is put on the wire; pure. The first thing that does not is the refusal.

Every limit is asked as "not within", so that what is no number is refused.
"""

import numpy as np

from robot.arm import ArmState
from robot.caps import ACCELERATION_CAP_MM_S2, ANGLE_CAP_RAD, LENGTH_CAP_MM, SPEED_CAP_MM_S
from robot.frames import Transform, distance_between
from robot.guard.messages import BeginMove
from robot.guard.rest import DISTURBED_MM, DISTURBED_RAD, REST_SPEED_MM_S, is_slow
from robot.kinematics import base_from_flange
from robot.refusal import Refusal, RefusalCode
from robot.safety import may_move

_WINDING_RAD = 0.1  # the same pose with a joint one turn on is not the arm that the path was checked for


def refuse_arm(move: BeginMove, reading: ArmState) -> Refusal | None:
    """Refusal of a motion for the arm's safety and rest, the caps (H12), its place (H04) and payload (H10)."""
    if not may_move(reading.safety):
        return Refusal(RefusalCode.ARM_NOT_READY, f"the arm reports {reading.safety}", None, None)
    if not is_slow(reading):
        message = "the arm is not at rest (mm/s)"
        return Refusal(RefusalCode.ARM_NOT_AT_REST, message, reading.tcp_speed_mm_s, REST_SPEED_MM_S)
    return (
        _refuse_pace(move)
        or _refuse_extent(move, reading)
        or _refuse_place(move, reading)
        or refuse_payload(move, reading)
    )


def refuse_late(message: str, late_s: float, limit_s: float) -> Refusal:
    """Refusal of a motion whose arm would be seen too late (H21)."""
    return Refusal(RefusalCode.FEEDBACK_LATE, message, late_s, limit_s)


def refuse_tcp(move: BeginMove, flange_from_tcp: Transform) -> Refusal | None:
    """Refusal of a motion for the TCP that the controller has active (H10)."""
    offset_mm, angle_rad = distance_between(move.flange_from_guide, flange_from_tcp)
    if not offset_mm <= move.tcp_tolerance_mm:
        message = "the controller's TCP is not the calibrated one (mm)"
        return Refusal(RefusalCode.TCP_MISMATCH, message, offset_mm, move.tcp_tolerance_mm)
    if not angle_rad <= move.tcp_tolerance_rad:
        message = "the controller's TCP is not the calibrated one (rad)"
        return Refusal(RefusalCode.TCP_MISMATCH, message, angle_rad, move.tcp_tolerance_rad)
    return None


def _refuse_pace(move: BeginMove) -> Refusal | None:
    """Whatever was planned and approved, faster is not put on the wire (H12)."""
    if not move.speed_mm_s <= SPEED_CAP_MM_S:
        return Refusal(RefusalCode.SPEED_ABOVE_CAP, "speed of the motion (mm/s)", move.speed_mm_s, SPEED_CAP_MM_S)
    if not move.acceleration_mm_s2 <= ACCELERATION_CAP_MM_S2:
        message = "acceleration of the motion (mm/s2)"
        return Refusal(RefusalCode.ACCELERATION_ABOVE_CAP, message, move.acceleration_mm_s2, ACCELERATION_CAP_MM_S2)
    return None


def _refuse_extent(move: BeginMove, reading: ArmState) -> Refusal | None:
    """Nor further, counted from where the arm is; it may have drifted since the plan as far as counts for nothing."""
    offset_mm, angle_rad = distance_between(reading.base_from_tcp, move.base_from_goal)
    if not offset_mm <= LENGTH_CAP_MM + DISTURBED_MM:
        return Refusal(RefusalCode.MOVE_TOO_FAR, "way to the goal (mm)", offset_mm, LENGTH_CAP_MM)
    if not angle_rad <= ANGLE_CAP_RAD + DISTURBED_RAD:
        return Refusal(RefusalCode.MOVE_TOO_FAR, "turn to the goal (rad)", angle_rad, ANGLE_CAP_RAD)
    return None


def _refuse_place(move: BeginMove, reading: ArmState) -> Refusal | None:
    """The arm must stand where the permit says, to the displacement that would void the image."""
    bound, now = (base_from_flange(joints) @ move.flange_from_guide for joints in _both(move, reading))
    offset_mm, angle_rad = distance_between(bound, now)
    winding_rad = float(np.abs(reading.joints_rad - move.start_joints_rad).max())
    code = RefusalCode.ARM_MOVED_SINCE_PERMIT
    if not offset_mm <= DISTURBED_MM:
        return Refusal(code, "the arm moved since the permit (mm)", offset_mm, DISTURBED_MM)
    if not angle_rad <= DISTURBED_RAD:
        return Refusal(code, "the arm turned since the permit (rad)", angle_rad, DISTURBED_RAD)
    if not winding_rad <= _WINDING_RAD:
        return Refusal(code, "a joint stands elsewhere than the permit says (rad)", winding_rad, _WINDING_RAD)
    return None


def _both(move: BeginMove, reading: ArmState) -> tuple[np.ndarray, np.ndarray]:
    return move.start_joints_rad, reading.joints_rad


def refuse_payload(move: BeginMove, reading: ArmState) -> Refusal | None:
    """Refusal of a motion for the payload that the controller has active (H10)."""
    code = RefusalCode.PAYLOAD_MISMATCH
    mass_kg = abs(reading.payload_kg - move.payload_kg)
    if not mass_kg <= move.payload_tolerance_kg:
        return Refusal(code, "the controller's payload differs (kg)", mass_kg, move.payload_tolerance_kg)
    centre_mm = float(np.linalg.norm(reading.payload_centre_mm - move.payload_centre_mm))
    if not centre_mm <= move.payload_tolerance_mm:
        return Refusal(code, "the controller's centre of mass differs (mm)", centre_mm, move.payload_tolerance_mm)
    return None
