"""What a test or the room may do with a simulated controller, in this process or in another."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simulator.controller.settings import Payload
from simulator.controller.state import ArmSample, ControllerState, WireRecord
from simulator.controller.states import Fault, PowerAction


class ControllerControl(Protocol):
    """Everything that is not on the wire; every call may come from any thread."""

    @property
    def address(self) -> str:
        """The loopback address of the three servers."""

    def state(self) -> ControllerState:
        """The present moment."""

    def inject(self, fault: Fault) -> None:
        """Plant a fault; it stays until cleared."""

    def clear(self, fault: Fault | None = None) -> None:
        """Take one fault away, or all; stops stay latched until they are released as on a real arm."""

    def release(self) -> None:
        """Clear all faults and bring the arm to running and normal, as a person at the pendant would, at once."""

    def power(self, action: PowerAction) -> None:
        """Switch the arm's power from the pendant."""

    def jog(self, joints_delta_rad: NDArray[np.float64], speed_rad_s: float = 0.2) -> None:
        """Move the joints (6,) by this much from the pendant, without a program; returns at once."""

    def jog_linear(self, step_in_base_mm: NDArray[np.float64], speed_mm_s: float = 20.0) -> None:
        """Move the TCP along a straight line from the pendant, without a program; returns at once."""

    def push(self, step_in_base_mm: NDArray[np.float64]) -> None:
        """Disturb the arm: the TCP yields by this much in base coordinates, and the encoders see it."""

    def teleport(self, joints_rad: NDArray[np.float64]) -> None:
        """Put the arm elsewhere between two cycles, to set a scene up."""

    def set_tcp(self, flange_from_tcp: NDArray[np.float64]) -> None:
        """Change the controller's TCP setting (4x4, mm), as somebody at the pendant could."""

    def set_payload(self, payload: Payload) -> None:
        """Change the controller's payload setting."""

    def set_speed_scaling(self, fraction: float) -> None:
        """Move the pendant's speed slider, 0 to 1."""

    def wire(self, after: int = -1) -> tuple[WireRecord, ...]:
        """What reached the controller, oldest first, numbers above `after`."""

    def samples(self, since_s: float = 0.0) -> tuple[ArmSample, ...]:
        """The arm's recorded cycles from a monotonic time on."""

    def close(self) -> None:
        """End the servers."""
