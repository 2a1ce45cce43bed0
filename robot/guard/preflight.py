"""What must hold before a motion is put on the wire; pure. The first thing that does not is the refusal."""

import numpy as np

from robot.arm import ArmState
from robot.frames import Transform, distance_between
from robot.guard.messages import BeginMove
from robot.guard.rest import DISTURBED_MM, DISTURBED_RAD, REST_SPEED_MM_S, is_slow
from robot.kinematics import base_from_flange
from robot.path import SPEED_CAP_MM_S
from robot.refusal import Refusal, RefusalCode
from robot.safety import may_move

_WINDING_RAD = 0.1  # the same pose with a joint one turn on is not the arm that the path was checked for


def refuse_arm(move: BeginMove, reading: ArmState) -> Refusal | None:
    """Refusal of a motion for the state of the arm: safety, foreign programs, rest, place (H04), payload (H10)."""
    if not may_move(reading.safety):
        return Refusal(RefusalCode.ARM_NOT_READY, f"the arm reports {reading.safety}", None, None)
    if not is_slow(reading):
        message = "the arm is not at rest (mm/s)"
        return Refusal(RefusalCode.ARM_NOT_AT_REST, message, reading.tcp_speed_mm_s, REST_SPEED_MM_S)
    return _refuse_speed(move) or _refuse_place(move, reading) or _refuse_payload(move, reading)


def refuse_tcp(move: BeginMove, flange_from_tcp: Transform) -> Refusal | None:
    """Refusal of a motion for the TCP that the controller has active (H10)."""
    offset_mm, angle_rad = distance_between(move.flange_from_guide, flange_from_tcp)
    if offset_mm > move.tcp_tolerance_mm:
        message = "the controller's TCP is not the calibrated one (mm)"
        return Refusal(RefusalCode.TCP_MISMATCH, message, offset_mm, move.tcp_tolerance_mm)
    if angle_rad > move.tcp_tolerance_rad:
        message = "the controller's TCP is not the calibrated one (rad)"
        return Refusal(RefusalCode.TCP_MISMATCH, message, angle_rad, move.tcp_tolerance_rad)
    return None


def _refuse_speed(move: BeginMove) -> Refusal | None:
    if move.speed_mm_s <= SPEED_CAP_MM_S:
        return None
    return Refusal(RefusalCode.SPEED_ABOVE_CAP, "speed of the motion (mm/s)", move.speed_mm_s, SPEED_CAP_MM_S)


def _refuse_place(move: BeginMove, reading: ArmState) -> Refusal | None:
    """The arm must stand where the permit says, to the displacement that would void the image."""
    bound, now = (base_from_flange(joints) @ move.flange_from_guide for joints in _both(move, reading))
    offset_mm, angle_rad = distance_between(bound, now)
    winding_rad = float(np.abs(reading.joints_rad - move.start_joints_rad).max())
    code = RefusalCode.ARM_MOVED_SINCE_PERMIT
    if offset_mm > DISTURBED_MM:
        return Refusal(code, "the arm moved since the permit (mm)", offset_mm, DISTURBED_MM)
    if angle_rad > DISTURBED_RAD:
        return Refusal(code, "the arm turned since the permit (rad)", angle_rad, DISTURBED_RAD)
    if winding_rad > _WINDING_RAD:
        return Refusal(code, "a joint stands elsewhere than the permit says (rad)", winding_rad, _WINDING_RAD)
    return None


def _both(move: BeginMove, reading: ArmState) -> tuple[np.ndarray, np.ndarray]:
    return move.start_joints_rad, reading.joints_rad


def _refuse_payload(move: BeginMove, reading: ArmState) -> Refusal | None:
    code = RefusalCode.PAYLOAD_MISMATCH
    mass_kg = abs(reading.payload_kg - move.payload_kg)
    if mass_kg > move.payload_tolerance_kg:
        return Refusal(code, "the controller's payload differs (kg)", mass_kg, move.payload_tolerance_kg)
    centre_mm = float(np.linalg.norm(reading.payload_centre_mm - move.payload_centre_mm))
    if centre_mm > move.payload_tolerance_mm:
        return Refusal(code, "the controller's centre of mass differs (mm)", centre_mm, move.payload_tolerance_mm)
    return None
