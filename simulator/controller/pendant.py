"""What a person at the pendant, or one who bumps into the arm, does to a controller without its program."""

from simulator.controller.arm import Array
from simulator.controller.core import ControllerCore
from simulator.controller.settings import Payload
from simulator.controller.states import PowerAction, RuntimeState


class Pendant:
    """Acts on a controller at once."""

    def __init__(self, core: ControllerCore) -> None:
        self._core = core

    def power(self, action: PowerAction) -> None:
        """Switch the arm's power."""
        match action:
            case PowerAction.OFF:
                self._core.power_off()
            case PowerAction.ON:
                self._core.safety.power_on(self._core.time_s)
            case PowerAction.RELEASE_BRAKES:
                self._core.safety.release_brakes(self._core.time_s)

    def jog(self, joints_delta_rad: Array, speed_rad_s: float) -> None:
        """Move the joints.

        Raises
        ------
        ValueError
            If a program is loaded, or the arm moves or may not move.
        """
        self._require_free_arm()
        self._core.arm.jog(joints_delta_rad, speed_rad_s)

    def jog_linear(self, step_in_base_mm: Array, speed_mm_s: float) -> None:
        """Move the TCP.

        Raises
        ------
        ValueError
            If a program is loaded, or the arm moves or may not move.
        """
        self._require_free_arm()
        self._core.arm.jog_linear(step_in_base_mm, speed_mm_s)

    def push(self, step_in_base_mm: Array) -> None:
        """Disturb an arm at rest, whether its brakes hold or its program does.

        Raises
        ------
        ValueError
            If the arm moves, or holds a motion: the push would be lost in it.
        """
        if self._core.arm.moving:
            raise ValueError("the arm is moving")
        self._core.arm.yield_to(step_in_base_mm)

    def set_tcp(self, flange_from_tcp: Array) -> None:
        """Change the TCP setting."""
        self._core.arm.flange_from_tcp = flange_from_tcp

    def set_payload(self, payload: Payload) -> None:
        """Change the payload setting."""
        self._core.payload = payload

    def set_speed_scaling(self, fraction: float) -> None:
        """Move the speed slider."""
        self._core.speed_scaling = fraction

    def _require_free_arm(self) -> None:
        if self._core.runtime_state is not RuntimeState.STOPPED or self._core.arm.moving:
            raise ValueError("a program is loaded or the arm is moving")
        if not self._core.safety.may_move:
            raise ValueError("the arm is stopped or without power")
