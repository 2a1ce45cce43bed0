"""How one simulated controller is set up, and what is true of its arm without its knowing."""

from dataclasses import dataclass, field
from math import radians

import numpy as np
from numpy.typing import NDArray

from simulator.controller.states import RobotMode, WatchdogOutcome

PARKED_RAD = tuple(radians(angle) for angle in (0.0, -90.0, 90.0, -90.0, -90.0, 0.0))


@dataclass(frozen=True, slots=True)
class ArmTruth:
    """The errors planted in the arm; none is visible on the wire."""

    kinematic_error_mm: float = 0.5  # rms over the workspace, flange of the true arm against the nominal one
    repeatability_mm: float = 0.1  # rms distance of an arrival from the pose that the encoders report
    repeatability_rad: float = 2e-4
    seed: int = 20170


@dataclass(frozen=True, slots=True)
class Payload:
    """Mass and its centre in flange coordinates."""

    mass_kg: float = 1.0
    centre_mm: tuple[float, float, float] = (0.0, 0.0, 50.0)


@dataclass(frozen=True, slots=True, eq=False)
class ControllerSettings:
    """Address, start pose, installation values, and the behaviours that nobody could check on a real controller."""

    address: str
    joints_rad: tuple[float, ...] = PARKED_RAD
    flange_from_tcp: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))  # mm, as calibrated
    payload: Payload = Payload()
    truth: ArmTruth = ArmTruth()
    version: tuple[int, int, int, int] = (3, 15, 8, 106339)
    protective_stop_pauses: bool = True  # False: the program is stopped instead
    watchdog_outcome: WatchdogOutcome = WatchdogOutcome.STOP_PROGRAM
    unlock_delay_s: float = 5.0  # after a protective stop; of every real controller
    emergency_robot_mode: RobotMode = RobotMode.POWER_OFF
    input_registers_exclusive: bool = True  # a second client that asks for them gets IN_USE
    tool_lever_mm: float = 250.0  # length that a linear move counts for one radian of turn

    @property
    def cycle_s(self) -> float:
        """125 Hz up to major version 3, 500 Hz from 5 on."""
        return 0.008 if self.version[0] <= 3 else 0.002
