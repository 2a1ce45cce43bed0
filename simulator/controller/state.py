"""What the room and the tests may know about a simulated controller at one moment."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.controller.settings import Payload
from simulator.controller.states import Fault, RobotMode, RuntimeState, SafetyMode


@dataclass(frozen=True, slots=True, eq=False)
class ControllerState:
    """One moment: what the controller reports beside where the arm really is (mm, rad)."""

    at_s: float  # CLOCK_MONOTONIC, comparable between processes of one machine
    controller_time_s: float
    joints_rad: NDArray[np.float64]  # (6,), as reported
    joint_speeds_rad_s: NDArray[np.float64]  # (6,), as reported
    base_from_flange_nominal: NDArray[np.float64]  # 4x4, what the controller computes
    flange_from_tcp: NDArray[np.float64]  # 4x4, the controller's setting
    true_joints_rad: NDArray[np.float64]  # (6,), with the offset of the last arrival
    base_from_flange_true: NDArray[np.float64]  # 4x4, where the flange is
    tcp_speed_mm_s: float
    payload: Payload
    robot_mode: RobotMode
    safety_mode: SafetyMode
    runtime_state: RuntimeState
    program: str  # name of the loaded script, "" without one
    moving: bool
    watchdog_hz: float  # 0 while not armed
    speed_scaling: float
    faults: frozenset[Fault]
    cycles: int
    latest_cycle_late_s: float  # the worst delay of a cycle behind its due time since the start
    stalled_s: float  # time given up after the process was held for longer than a catch-up


@dataclass(frozen=True, slots=True)
class ArmSample:
    """One controller cycle of the arm as reported."""

    at_s: float
    controller_time_s: float
    joints_rad: tuple[float, ...]
    tcp_in_base_mm: tuple[float, float, float]
    tcp_speed_mm_s: float


@dataclass(frozen=True, slots=True)
class WireRecord:
    """Something that reached the controller: an input packet, a script, a dashboard command, a connection."""

    number: int
    at_s: float  # CLOCK_MONOTONIC
    port: int
    kind: str  # connected, disconnected, request, input, script, dashboard; of the controller itself: watchdog
    text: str  # the dashboard command, the program's name, the command and its arguments
    command: int = -1  # in_int_register_0 of an input packet
