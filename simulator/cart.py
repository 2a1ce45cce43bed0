"""The cart under the arm, whose brakes give way once."""

import numpy as np
from numpy.typing import NDArray

from simulator.controller import ControllerState
from simulator.frames import ROOM_FROM_BASE

Array = NDArray[np.float64]

_MOVED_RAD = 1e-3  # of any joint: more than a disturbance


class Cart:
    """Where the arm's base truly is."""

    def __init__(self, settling_in_room_mm: Array) -> None:
        self._settling = settling_in_room_mm
        self._joints_when_seen: Array | None = None
        self._settled = False

    def room_from_base(self, arm: ControllerState) -> Array:
        """Pose of the base, 4x4, mm; rolls as soon as the arm moved since it was first seen."""
        if self._joints_when_seen is not None:
            moved = np.abs(arm.joints_rad - self._joints_when_seen).max() > _MOVED_RAD
            self._settled = self._settled or bool(moved)
        pose = ROOM_FROM_BASE.copy()
        if self._settled:
            pose[:3, 3] += self._settling
        return pose

    def seen(self, arm: ControllerState) -> None:
        """An image shows the guide, so that what happens to the base from now on matters."""
        if self._joints_when_seen is None:
            self._joints_when_seen = arm.joints_rad.copy()
