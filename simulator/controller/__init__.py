"""A simulated UR5 controller: dashboard, script and RTDE servers over an arm whose joints are integrated.

`Controller(settings)` runs in this process, `ControllerProcess(settings)` in another; both are context managers
and offer `ControllerControl`.
"""

from simulator.controller.addresses import free_loopback_address
from simulator.controller.control import ControllerControl
from simulator.controller.controller import Controller
from simulator.controller.process import ControllerProcess
from simulator.controller.settings import ArmTruth, ControllerSettings, Payload
from simulator.controller.state import ArmSample, ControllerState, WireRecord
from simulator.controller.states import (
    Fault,
    PowerAction,
    RobotMode,
    RuntimeState,
    SafetyBit,
    SafetyMode,
    WatchdogOutcome,
)

__all__ = [
    "ArmSample",
    "ArmTruth",
    "Controller",
    "ControllerControl",
    "ControllerProcess",
    "ControllerSettings",
    "ControllerState",
    "Fault",
    "Payload",
    "PowerAction",
    "RobotMode",
    "RuntimeState",
    "SafetyBit",
    "SafetyMode",
    "WatchdogOutcome",
    "WireRecord",
    "free_loopback_address",
]
