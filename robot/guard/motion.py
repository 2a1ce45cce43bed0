"""Judgement of a running motion, reading by reading; pure."""

import numpy as np

from robot.arm import ArmState
from robot.caps import SPEED_CAP_MM_S, TURN_SPEED_CAP_RAD_S
from robot.frames import Array, distance_between
from robot.guard.deviation import PathWatch, TcpWatch
from robot.guard.force import FORCE_RISE_N, ForceWatch
from robot.guard.messages import BeginMove, EndCause
from robot.guard.preflight import refuse_payload
from robot.guard.rest import DISTURBED_MM, DISTURBED_RAD, RestWatch
from robot.safety import SafetyState

ARRIVAL_MM = 0.1
ARRIVAL_RAD = float(np.deg2rad(0.05))
ARRIVAL_REST_S = 0.5
_START_WITHIN_S = 0.3  # a controller starts a linear move within a few cycles; frozen values look like no start
_OVERSPEED = 1.25  # times a cap (H12): above the noise of the reported speeds
_OVERSPEED_READINGS = 3
_NO_PROGRAM_READINGS = 3  # at 125 Hz 24 ms: the safety bits that explain it may come a cycle later
_OVERDUE_FACTOR = 4.0  # of the planned duration: a pendant's speed slider may slow a motion
_OVERDUE_S = 5.0

_SAFETY_CAUSES = {
    SafetyState.PROTECTIVE_STOP: EndCause.PROTECTIVE_STOP,
    SafetyState.SAFEGUARD_STOP: EndCause.SAFEGUARD_STOP,
    SafetyState.EMERGENCY_STOP: EndCause.EMERGENCY_STOP,
    SafetyState.OFF: EndCause.ARM_OFF,
    SafetyState.VIOLATION: EndCause.SAFETY_FAULT,
    SafetyState.FAULT: EndCause.SAFETY_FAULT,
    SafetyState.RECOVERY: EndCause.SAFETY_FAULT,
}


class MotionJudge:
    """Says when a motion has to end, and why.

    Parameters
    ----------
    resting_force_n : (3,)
        At the TCP before the motion, base axes.
    """

    def __init__(self, move: BeginMove, start: ArmState, resting_force_n: Array, began_at_s: float) -> None:
        self._move = move
        self._start = start
        self._began_at_s = began_at_s
        self._rest = RestWatch()
        self._force = ForceWatch(resting_force_n)
        self._tcp = TcpWatch(move, start)
        self._path = PathWatch(move, start)
        self._departed = is_at(start, move)  # a goal that is here already needs no departure
        self._fast = 0
        self._without_program = 0

    def judge(self, reading: ArmState) -> EndCause | None:
        """Cause to end the motion after this reading, or None to go on."""
        rest_s = self._rest.observe(reading)
        self._departed = self._departed or self._has_departed(reading)
        self._fast = self._fast + 1 if _is_too_fast(reading) else 0
        self._without_program = 0 if reading.program_running else self._without_program + 1
        return self._worst(reading) or self._unlike_approved(reading) or self._end_of_way(reading, rest_s)

    def _worst(self, reading: ArmState) -> EndCause | None:
        if reading.safety in _SAFETY_CAUSES:
            return _SAFETY_CAUSES[reading.safety]
        if self._fast >= _OVERSPEED_READINGS:
            return EndCause.OVERSPEED
        return EndCause.CONTROL_LOST if self._without_program >= _NO_PROGRAM_READINGS else None

    def _unlike_approved(self, reading: ArmState) -> EndCause | None:
        """What was compared before the start and is no longer so, and what the way was never to meet."""
        pressed = self._force.observe(reading) > FORCE_RISE_N
        other_tcp, off_path = self._tcp.has_changed(reading), self._path.is_off(reading)
        if pressed:
            return EndCause.FORCE_RISE
        if other_tcp:  # before the path, which the reported pose leaves with it
            return EndCause.TCP_CHANGED
        if refuse_payload(self._move, reading) is not None:
            return EndCause.PAYLOAD_CHANGED
        return EndCause.OFF_PATH if off_path else None

    def _end_of_way(self, reading: ArmState, rest_s: float) -> EndCause | None:
        elapsed_s = reading.received_at_s - self._began_at_s
        if not self._departed:
            return EndCause.NOT_STARTED if elapsed_s > _START_WITHIN_S else None
        if rest_s >= ARRIVAL_REST_S:
            return EndCause.ARRIVED if is_at(reading, self._move) else EndCause.MISSED
        overdue = elapsed_s > _OVERDUE_FACTOR * self._move.duration_s + _OVERDUE_S
        return EndCause.OVERDUE if overdue else None

    def _has_departed(self, reading: ArmState) -> bool:
        offset_mm, angle_rad = distance_between(self._start.base_from_tcp, reading.base_from_tcp)
        return offset_mm > DISTURBED_MM or angle_rad > DISTURBED_RAD


def is_at(reading: ArmState, move: BeginMove) -> bool:
    """Whether the TCP is at the goal of a motion."""
    offset_mm, angle_rad = distance_between(reading.base_from_tcp, move.base_from_goal)
    return offset_mm <= ARRIVAL_MM and angle_rad <= ARRIVAL_RAD


def _is_too_fast(reading: ArmState) -> bool:
    return (
        reading.tcp_speed_mm_s > _OVERSPEED * SPEED_CAP_MM_S
        or reading.tcp_turn_speed_rad_s > _OVERSPEED * TURN_SPEED_CAP_RAD_S
    )
