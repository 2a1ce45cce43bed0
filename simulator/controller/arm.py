"""The arm: joints that follow a path, reported by a nominal model, standing where a true one puts them."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from simulator import kinematics
from simulator.controller.paths import JointPath, LinearPath, Path
from simulator.controller.ramps import Ramp
from simulator.controller.settings import ControllerSettings

Array = NDArray[np.float64]

# A stop by the controller (protective stop, stopped program) brings the arm to rest within this time.
STOPPING_TIME_S = 0.1
# Disturbances and jogs start and end as briskly as a hand does.
_JOG_ACCELERATION_MM_S2 = 500.0
_JOG_ACCELERATION_RAD_S2 = 2.0
_PUSH_SPEED_MM_S = 50.0
_SETTLING_TRAVEL_MM = 2.0  # a shorter motion keeps part of the offset that it started with
_SLOWEST_MM_S = 1.0  # below this a joint motion stops in a time of its own, whatever its TCP does


@dataclass(slots=True, eq=False)
class Motion:
    """One motion in progress."""

    path: Path
    ramp: Ramp
    offset_before_rad: Array  # (6,), of the arrival that it starts from
    offset_after_rad: Array  # (6,), of its own arrival


def shifted(pose: Array, step_mm: Array) -> Array:
    """A 4x4 pose moved along without turning."""
    moved = np.array(pose)
    moved[:3, 3] += step_mm
    return moved


class Arm:
    """Joint positions and speeds, advanced cycle by cycle."""

    def __init__(self, settings: ControllerSettings) -> None:
        truth = settings.truth
        self.nominal = kinematics.NOMINAL_UR5
        self.true = kinematics.planted_links(self.nominal, truth.kinematic_error_mm, truth.seed)
        self.joints_rad: Array = np.array(settings.joints_rad, dtype=np.float64)
        self.speeds_rad_s: Array = np.zeros(kinematics.JOINTS)
        self.accelerations_rad_s2: Array = np.zeros(kinematics.JOINTS)
        self.flange_from_tcp: Array = np.array(settings.flange_from_tcp, dtype=np.float64)
        self._lever_mm = settings.tool_lever_mm
        self._truth = truth
        self._rng = np.random.default_rng(truth.seed + 1)
        self._offset_rad = self._draw_offset()
        self._motion: Motion | None = None

    @property
    def moving(self) -> bool:
        """Whether a motion is under way or held by a pause."""
        return self._motion is not None

    @property
    def at_rest(self) -> bool:
        """Whether nothing moves now."""
        ended = self._motion is None or self._motion.ramp.at_rest
        return ended and not self.speeds_rad_s.any()

    @property
    def base_from_flange(self) -> Array:
        """4x4 in mm, as the controller computes it."""
        return kinematics.base_from_flange(self.nominal, self.joints_rad)

    @property
    def base_from_tcp(self) -> Array:
        """4x4 in mm, as the controller reports it."""
        return self.base_from_flange @ self.flange_from_tcp

    @property
    def true_joints_rad(self) -> Array:
        """(6,), with the offset that the present place was reached with."""
        return self.joints_rad + self._offset_rad

    @property
    def base_from_flange_true(self) -> Array:
        """4x4 in mm, where the flange is."""
        return kinematics.base_from_flange(self.true, self.true_joints_rad)

    @property
    def tcp_velocity(self) -> Array:
        """(6,), mm/s and rad/s in base coordinates."""
        rates = kinematics.jacobian(self.nominal, self.joints_rad, self.flange_from_tcp[:3, 3])
        velocity: Array = rates @ self.speeds_rad_s
        return velocity

    def move_linear(self, base_from_goal: Array, speed_mm_s: float, acceleration_mm_s2: float) -> None:
        """Begin a straight motion of the TCP."""
        path = LinearPath(self.nominal, self.flange_from_tcp, self.base_from_tcp, base_from_goal, self._lever_mm)
        self._begin(path, Ramp(path.length, speed_mm_s, acceleration_mm_s2))

    def move_joints(self, goal_rad: Array, speed_rad_s: float, acceleration_rad_s2: float) -> None:
        """Begin a motion of all joints in step."""
        path = JointPath(self.joints_rad, goal_rad)
        self._begin(path, Ramp(path.length, speed_rad_s, acceleration_rad_s2))

    def jog(self, joints_delta_rad: Array, speed_rad_s: float) -> None:
        """Move as the pendant's arrows do."""
        self.move_joints(self.joints_rad + joints_delta_rad, speed_rad_s, _JOG_ACCELERATION_RAD_S2)

    def jog_linear(self, step_in_base_mm: Array, speed_mm_s: float) -> None:
        """Shift the TCP without turning it."""
        self.move_linear(shifted(self.base_from_tcp, step_in_base_mm), speed_mm_s, _JOG_ACCELERATION_MM_S2)

    def yield_to(self, step_in_base_mm: Array) -> None:
        """Be pushed; where the arm settles is its old arrival's offset, taken along."""
        path = LinearPath(
            self.nominal,
            self.flange_from_tcp,
            self.base_from_tcp,
            shifted(self.base_from_tcp, step_in_base_mm),
            self._lever_mm,
        )
        ramp = Ramp(path.length, _PUSH_SPEED_MM_S, _JOG_ACCELERATION_MM_S2)
        self._motion = Motion(path, ramp, self._offset_rad, self._offset_rad)

    def teleport(self, joints_rad: Array) -> None:
        """Stand elsewhere, at rest."""
        self.joints_rad = np.array(joints_rad, dtype=np.float64)
        self._offset_rad = self._draw_offset()
        self.drop_motion()

    def shorten(self, fraction: float) -> None:
        """Let the motion just begun end early, as if the arm gave up on the way."""
        if self._motion is not None:
            self._motion.ramp.length *= fraction

    def hold(self) -> None:
        """Come to rest on the path within the stopping time; `release` goes on from there."""
        if self._motion is not None:
            self._motion.ramp.hold(STOPPING_TIME_S)

    def release(self) -> None:
        """Go on with a motion that was held."""
        if self._motion is not None:
            self._motion.ramp.release()

    def brake_linear(self, deceleration_mm_s2: float) -> None:
        """Slow down along the path, as stopl does."""
        if self._motion is None:
            return
        ramp = self._motion.ramp
        if isinstance(self._motion.path, LinearPath):
            ramp.brake(deceleration_mm_s2)
        else:
            tcp_speed = float(np.linalg.norm(self.tcp_velocity[:3]))
            ramp.brake(deceleration_mm_s2 * ramp.speed / max(tcp_speed, _SLOWEST_MM_S))

    def brake_joints(self, deceleration_rad_s2: float) -> None:
        """Slow all joints down in step, leaving the path as stopj does."""
        fastest = float(np.abs(self.speeds_rad_s).max())
        if self._motion is None or fastest == 0.0:  # also a motion that has only just begun
            self.drop_motion()
            return
        run_out = fastest / (2.0 * deceleration_rad_s2)  # s: half of the braking time
        path = JointPath(self.joints_rad, self.joints_rad + self.speeds_rad_s * run_out)
        self._motion.path = path
        self._motion.ramp = Ramp(path.length, fastest, deceleration_rad_s2, fastest)
        self._motion.offset_before_rad = self._motion.offset_after_rad = self._offset_rad

    def drop_motion(self) -> None:
        """Forget the motion; the joints stay where they are."""
        self._motion = None
        self._record(self.joints_rad, 1.0)

    def advance(self, cycle_s: float, scaling: float) -> bool:
        """Move on by one cycle; False where the arm could not follow its path and stands."""
        motion = self._motion
        if motion is None:
            self._record(self.joints_rad, cycle_s)
            return True
        motion.ramp.advance(cycle_s, scaling)
        joints = motion.path.joints_at(motion.ramp.position, self.joints_rad)
        if joints is None or not self._can_follow(joints, cycle_s):
            self.drop_motion()
            return False
        self._record(joints, cycle_s)
        fraction = motion.ramp.position / motion.ramp.length if motion.ramp.length > 0.0 else 1.0
        self._offset_rad = motion.offset_before_rad + fraction * (motion.offset_after_rad - motion.offset_before_rad)
        if motion.ramp.arrived:
            self._motion = None
        return True

    def _can_follow(self, joints_rad: Array, cycle_s: float) -> bool:
        fastest_rad_s = np.abs(joints_rad - self.joints_rad).max() / cycle_s
        within = np.abs(joints_rad).max() <= kinematics.JOINT_LIMIT_RAD
        return bool(within and fastest_rad_s <= kinematics.JOINT_SPEED_LIMIT_RAD_S)

    def _begin(self, path: Path, ramp: Ramp) -> None:
        settled = min(1.0, path.travel_mm / _SETTLING_TRAVEL_MM)
        after = self._offset_rad + settled * (self._draw_offset() - self._offset_rad)
        self._motion = Motion(path, ramp, self._offset_rad, after)

    def _record(self, joints_rad: Array, cycle_s: float) -> None:
        speeds = (joints_rad - self.joints_rad) / cycle_s
        self.accelerations_rad_s2 = (speeds - self.speeds_rad_s) / cycle_s
        self.speeds_rad_s, self.joints_rad = speeds, joints_rad

    def _draw_offset(self) -> Array:
        """Where gears and belts let the arm settle: a joint offset that shifts the flange by the repeatability."""
        spread = np.repeat([self._truth.repeatability_mm, self._truth.repeatability_rad], 3) / sqrt(3.0)
        shift = self._rng.standard_normal(6) * spread
        offset: Array = np.linalg.pinv(kinematics.jacobian(self.true, self.joints_rad), rcond=1e-2) @ shift
        return offset
