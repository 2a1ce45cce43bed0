"""Whether a running motion is still the approved one: on its line, with the TCP that was compared; pure."""

import numpy as np

from robot.arm import ArmState
from robot.frames import Array, Transform, distance_between
from robot.guard.messages import BeginMove
from robot.kinematics import base_from_flange

OFF_PATH_MM = 1.0  # a UR5 keeps a straight line to its repeatability of 0.1 mm; a tenth of what a clearance may be
OFF_PATH_RAD = float(np.deg2rad(1.0))
_READINGS = 3  # in a row, so that one that was read while the next packet arrived is no deviation


class PathWatch:
    """Distance from the straight way to the goal, position and shortest turn each by itself."""

    def __init__(self, move: BeginMove, start: ArmState) -> None:
        self._start = start.base_from_tcp
        self._goal = move.base_from_goal
        self._turn_rad = distance_between(self._start, self._goal)[1]
        self._count = 0

    def is_off(self, reading: ArmState) -> bool:
        """Whether this reading is the last of several off the way."""
        now = reading.base_from_tcp
        detour_rad = distance_between(self._start, now)[1] + distance_between(now, self._goal)[1] - self._turn_rad
        away_mm = _distance_from_segment(now[:3, 3], self._start[:3, 3], self._goal[:3, 3])
        self._count = self._count + 1 if away_mm > OFF_PATH_MM or detour_rad > OFF_PATH_RAD else 0
        return self._count >= _READINGS


class TcpWatch:
    """Notices a TCP that is changed at the pendant amid a motion: the reported pose leaps, the joints do not (H10).

    What joints and pose imply differs from the calibrated TCP by the arm's own calibration, which our nominal model
    does not know; that part changes slowly along a path, so each reading is compared with those before it.
    """

    def __init__(self, move: BeginMove, start: ArmState) -> None:
        self._move = move
        self._flange_from_tcp = _implied(start)
        self._count = 0

    def has_changed(self, reading: ArmState) -> bool:
        """Whether this reading is the last of several with another TCP."""
        implied = _implied(reading)
        if _is_same(self._move, self._flange_from_tcp, implied):
            self._flange_from_tcp = implied
            self._count = 0
        else:
            self._count += 1
        return self._count >= _READINGS


def has_kept_tcp(move: BeginMove, before: ArmState, now: ArmState) -> bool:
    """Whether two readings of an arm at rest imply one TCP."""
    return _is_same(move, _implied(before), _implied(now))


def _is_same(move: BeginMove, flange_from_a: Transform, flange_from_b: Transform) -> bool:
    offset_mm, angle_rad = distance_between(flange_from_a, flange_from_b)
    return offset_mm <= move.tcp_tolerance_mm and angle_rad <= move.tcp_tolerance_rad


def _implied(reading: ArmState) -> Transform:
    return np.asarray(np.linalg.solve(base_from_flange(reading.joints_rad), reading.base_from_tcp), dtype=np.float64)


def _distance_from_segment(point_mm: Array, start_mm: Array, end_mm: Array) -> float:
    way_mm = end_mm - start_mm
    length_mm2 = float(way_mm @ way_mm)
    share = float(np.clip((point_mm - start_mm) @ way_mm / length_mm2, 0.0, 1.0)) if length_mm2 > 0.0 else 0.0
    return float(np.linalg.norm(point_mm - start_mm - share * way_mm))
