"""The RTDE variables: their types, and their values at one moment."""

from typing import TYPE_CHECKING

import numpy as np

from simulator.controller.framing import Value
from simulator.controller.poses import MM_PER_M, pose_from_matrix
from simulator.controller.registers import REGISTERS
from simulator.controller.states import RobotMode, RuntimeState

if TYPE_CHECKING:
    from simulator.controller.core import ControllerCore

OUTPUT_TYPES = {
    "timestamp": "DOUBLE",
    **dict.fromkeys(("target_q", "target_qd", "target_qdd", "target_current", "target_moment"), "VECTOR6D"),
    **dict.fromkeys(("actual_q", "actual_qd", "actual_current", "joint_control_output"), "VECTOR6D"),
    **dict.fromkeys(("actual_TCP_pose", "actual_TCP_speed", "actual_TCP_force"), "VECTOR6D"),
    **dict.fromkeys(("target_TCP_pose", "target_TCP_speed", "payload_inertia", "ft_raw_wrench"), "VECTOR6D"),
    **dict.fromkeys(("joint_temperatures", "actual_joint_voltage", "actual_current_as_torque"), "VECTOR6D"),
    **dict.fromkeys(("actual_tool_accelerometer", "payload_cog"), "VECTOR3D"),
    **dict.fromkeys(("actual_digital_input_bits", "actual_digital_output_bits"), "UINT64"),
    **dict.fromkeys(("robot_mode", "safety_mode", "tool_output_voltage"), "INT32"),
    "joint_mode": "VECTOR6INT32",
    **dict.fromkeys(("runtime_state", "robot_status_bits", "safety_status_bits"), "UINT32"),
    **dict.fromkeys(("actual_execution_time", "speed_scaling", "target_speed_fraction", "actual_momentum"), "DOUBLE"),
    **dict.fromkeys(("actual_main_voltage", "actual_robot_voltage", "actual_robot_current", "payload"), "DOUBLE"),
    **dict.fromkeys((f"standard_analog_{way}put{i}" for way in ("in", "out") for i in (0, 1)), "DOUBLE"),
    **{f"output_int_register_{i}": "INT32" for i in range(REGISTERS)},
    **{f"output_double_register_{i}": "DOUBLE" for i in range(REGISTERS)},
}

INPUT_TYPES = {
    **{f"input_int_register_{i}": "INT32" for i in range(REGISTERS)},
    **{f"input_double_register_{i}": "DOUBLE" for i in range(REGISTERS)},
    "external_force_torque": "VECTOR6D",
    "speed_slider_mask": "UINT32",
    "speed_slider_fraction": "DOUBLE",
    **dict.fromkeys(("standard_digital_output_mask", "standard_digital_output"), "UINT8"),
    **dict.fromkeys(("configurable_digital_output_mask", "configurable_digital_output"), "UINT8"),
    **dict.fromkeys(("tool_digital_output_mask", "tool_digital_output"), "UINT8"),
    **dict.fromkeys(("standard_analog_output_mask", "standard_analog_output_type"), "UINT8"),
    **{f"standard_analog_output_{i}": "DOUBLE" for i in (0, 1)},
}

_ZEROS: dict[str, Value] = {
    "DOUBLE": 0.0,
    "VECTOR3D": (0.0,) * 3,
    "VECTOR6D": (0.0,) * 6,
    "INT32": 0,
    "UINT32": 0,
    "UINT64": 0,
    "VECTOR6INT32": (0,) * 6,
}
_CONSTANTS: dict[str, Value] = {name: _ZEROS[kind] for name, kind in OUTPUT_TYPES.items()} | {
    "joint_temperatures": (28.0,) * 6,
    "actual_joint_voltage": (48.0,) * 6,
    "actual_main_voltage": 48.0,
    "actual_robot_voltage": 48.0,
    "actual_robot_current": 0.6,
    "actual_tool_accelerometer": (0.0, 0.0, 9.81),
}
_JOINT_RUNNING, _JOINT_POWER_OFF = 253, 239
_POWER_BIT, _PROGRAM_BIT = 1, 2


def output_values(core: "ControllerCore") -> dict[str, Value]:
    """All output variables now; those that nothing here depends on keep a plausible constant."""
    arm, registers = core.arm, core.registers
    joints, speeds = _vector(arm.joints_rad), _vector(arm.speeds_rad_s)
    pose, velocity = pose_from_matrix(arm.base_from_tcp), arm.tcp_velocity
    speed = _vector(np.concatenate([velocity[:3] / MM_PER_M, velocity[3:]]))
    powered = core.safety.robot_mode is RobotMode.RUNNING
    values = _CONSTANTS | {
        "timestamp": core.time_s,
        "target_q": joints,
        "actual_q": joints,
        "target_qd": speeds,
        "actual_qd": speeds,
        "target_qdd": _vector(arm.accelerations_rad_s2),
        "actual_TCP_pose": pose,
        "target_TCP_pose": pose,
        "actual_TCP_speed": speed,
        "target_TCP_speed": speed,
        "actual_TCP_force": core.tcp_force_n,
        "robot_mode": int(core.safety.robot_mode),
        "joint_mode": (_JOINT_RUNNING if powered else _JOINT_POWER_OFF,) * 6,
        "safety_mode": int(core.safety.mode),
        "safety_status_bits": core.safety.bits,
        "robot_status_bits": _POWER_BIT * powered + _PROGRAM_BIT * (core.runtime_state is not RuntimeState.STOPPED),
        "runtime_state": int(core.runtime_state),
        "speed_scaling": core.speed_scaling,
        "target_speed_fraction": core.speed_scaling,
        "payload": core.payload.mass_kg,
        "payload_cog": tuple(value / MM_PER_M for value in core.payload.centre_mm),
    }
    values.update(zip(_INT_NAMES, registers.output_integers, strict=True))
    values.update(zip(_DOUBLE_NAMES, registers.output_doubles, strict=True))
    return values


_INT_NAMES = [f"output_int_register_{i}" for i in range(REGISTERS)]
_DOUBLE_NAMES = [f"output_double_register_{i}" for i in range(REGISTERS)]


def _vector(values: np.ndarray) -> tuple[float, ...]:
    return tuple(values.tolist())
