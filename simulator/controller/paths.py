"""The two shapes of motion a UR controller makes: straight in space, straight in joint space."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator import kinematics
from simulator.controller.poses import inverse

Array = NDArray[np.float64]


_TYPICAL_REACH_MM = 500.0  # of the tool from a joint's axis


class Path(Protocol):
    """A curve through joint space, measured in the unit of its speed."""

    @property
    def length(self) -> float:
        """From start to end."""

    @property
    def travel_mm(self) -> float:
        """About how far the tool goes."""

    def joints_at(self, position: float, seed_rad: Array) -> Array | None:
        """Joint angles (6,) at a position along the path, or None where the arm cannot follow."""


class LinearPath:
    """TCP on a straight line (mm), turning by slerp in step with it.

    A turn counts as the arc of a lever, so that a turn in place takes its time too.
    """

    def __init__(
        self,
        links: kinematics.Links,
        flange_from_tcp: Array,
        base_from_start: Array,
        base_from_goal: Array,
        lever_mm: float,
    ) -> None:
        self._links = links
        self._tcp_from_flange = inverse(flange_from_tcp)
        self._start = base_from_start
        difference = kinematics.pose_difference(base_from_start, base_from_goal)
        self._shift_mm, self._turn_rad = difference[:3], difference[3:]
        self.length = float(max(np.linalg.norm(self._shift_mm), lever_mm * np.linalg.norm(self._turn_rad)))
        self.travel_mm = self.length

    def joints_at(self, position: float, seed_rad: Array) -> Array | None:
        """By seeded inverse kinematics of the nominal arm."""
        fraction = position / self.length if self.length > 0.0 else 1.0
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_rotvec(self._turn_rad * fraction).as_matrix() @ self._start[:3, :3]
        pose[:3, 3] = self._start[:3, 3] + fraction * self._shift_mm
        return kinematics.solve_joints(self._links, pose @ self._tcp_from_flange, seed_rad)


class JointPath:
    """All joints in step with the one that turns most (rad)."""

    def __init__(self, start_rad: Array, goal_rad: Array) -> None:
        self._start, self._difference = np.array(start_rad), goal_rad - start_rad
        self.length = float(np.abs(self._difference).max())
        self.travel_mm = self.length * _TYPICAL_REACH_MM

    def joints_at(self, position: float, seed_rad: Array) -> Array | None:
        """By interpolation; needs no seed."""
        del seed_rad
        fraction = position / self.length if self.length > 0.0 else 1.0
        joints: Array = self._start + fraction * self._difference
        return joints
