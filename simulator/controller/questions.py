"""Kinematic questions to the controller, and its settings, as the control program asks them (metres and radians)."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simulator import kinematics
from simulator.controller.poses import MM_PER_M, inverse, matrix_from_pose, pose_from_matrix
from simulator.controller.settings import Payload

if TYPE_CHECKING:
    from simulator.controller.program import ControlProgram

Array = NDArray[np.float64]

_JOINTS = _POSE = 6


class ProgramError(RuntimeError):
    """The script would have failed here; the controller stops it."""


def joints_now(program: "ControlProgram") -> tuple[float, ...]:
    """Joint angles at this moment."""
    return tuple(program.core.arm.joints_rad.tolist())


def forward(program: "ControlProgram", joints: tuple[float, ...], flange_from_tcp: Array) -> tuple[float, ...]:
    """Pose of a TCP for joint angles."""
    flange = kinematics.base_from_flange(program.core.arm.nominal, np.array(joints))
    return pose_from_matrix(flange @ flange_from_tcp)


def inverse_kinematics(program: "ControlProgram", pose: tuple[float, ...], near: tuple[float, ...]) -> Array | None:
    """Joint angles for a pose of the active TCP, or None."""
    arm = program.core.arm
    return kinematics.solve_joints(arm.nominal, matrix_from_pose(pose) @ inverse(arm.flange_from_tcp), np.array(near))


def reachable(program: "ControlProgram", pose: tuple[float, ...], near: tuple[float, ...]) -> Array:
    """Joint angles for a pose of the active TCP.

    Raises
    ------
    ProgramError
        If there are none: a script dies of it.
    """
    joints = inverse_kinematics(program, pose, near)
    if joints is None:
        raise ProgramError("inverse kinematics has no solution")
    return joints


def tell_inverse(program: "ControlProgram") -> None:
    """Inverse kinematics near the present joints."""
    program.result(tuple(reachable(program, program.doubles(0, _POSE), joints_now(program))))


def tell_inverse_near(program: "ControlProgram") -> None:
    """Inverse kinematics near given joints."""
    program.result(tuple(reachable(program, program.doubles(0, _POSE), program.doubles(6, _JOINTS))))


def tell_has_inverse(program: "ControlProgram") -> None:
    """Whether inverse kinematics has a solution near the present joints."""
    program.verdict(inverse_kinematics(program, program.doubles(0, _POSE), joints_now(program)) is not None)


def tell_has_inverse_near(program: "ControlProgram") -> None:
    """Whether inverse kinematics has a solution near given joints."""
    solution = inverse_kinematics(program, program.doubles(0, _POSE), program.doubles(6, _JOINTS))
    program.verdict(solution is not None)


def tell_joints_allowed(program: "ControlProgram") -> None:
    """Whether joints are within their range."""
    program.verdict(bool(np.all(np.abs(program.doubles(0, _JOINTS)) <= kinematics.JOINT_LIMIT_RAD)))


def tell_pose(program: "ControlProgram") -> None:
    """Forward kinematics of the present joints and TCP."""
    program.result(pose_from_matrix(program.core.arm.base_from_tcp))


def tell_forward(program: "ControlProgram") -> None:
    """Forward kinematics of given joints and TCP."""
    program.result(forward(program, program.doubles(0, _JOINTS), matrix_from_pose(program.doubles(6, _POSE))))


def tell_flange_pose(program: "ControlProgram") -> None:
    """Forward kinematics without a TCP."""
    program.result(pose_from_matrix(program.core.arm.base_from_flange))


def tell_composed(program: "ControlProgram") -> None:
    """Product of two poses."""
    first, second = matrix_from_pose(program.doubles(0, _POSE)), matrix_from_pose(program.doubles(6, _POSE))
    program.result(pose_from_matrix(first @ second))


def tell_joints(program: "ControlProgram") -> None:
    """Present joints, also when asked for earlier ones."""
    program.result(joints_now(program))


def tell_steady(program: "ControlProgram") -> None:
    """Whether the arm is at rest."""
    program.verdict(program.core.arm.at_rest)


def tell_tcp(program: "ControlProgram") -> None:
    """The active TCP."""
    program.result(pose_from_matrix(program.core.arm.flange_from_tcp))


def set_tcp(program: "ControlProgram") -> None:
    """Change the active TCP."""
    program.core.arm.flange_from_tcp = matrix_from_pose(program.doubles(0, _POSE))


def set_payload(program: "ControlProgram") -> None:
    """Change the payload and its centre."""
    mass, x, y, z = program.doubles(0, 4)
    program.core.payload = Payload(mass, (x * MM_PER_M, y * MM_PER_M, z * MM_PER_M))
