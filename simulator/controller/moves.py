"""Moves and stops of the control program, as steps of one cycle each (metres, radians and seconds as on the wire)."""

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from simulator.controller.async_status import AsyncStatus
from simulator.controller.poses import MM_PER_M, matrix_from_pose
from simulator.controller.questions import Array, forward, joints_now, reachable
from simulator.controller.states import Fault

if TYPE_CHECKING:
    from simulator.controller.program import ControlProgram

_JOINTS = _POSE = 6
_LINEAR_STOP_M_S2 = 10.0
_SHORTFALL = 0.9  # of the way, where a motion that falls short ends


def _until_rest(program: "ControlProgram") -> Iterator[None]:
    """A new command waits here until the arm has braked from the one before."""
    arm = program.core.arm
    arm.hold()
    while not arm.at_rest:
        yield
    arm.drop_motion()


def _joint_motion(program: "ControlProgram", goal: Array, speed: float, acceleration: float) -> Iterator[None]:
    yield from _until_rest(program)
    program.core.arm.move_joints(goal, speed, acceleration)
    yield from _arrival(program)


def _linear_motion(
    program: "ControlProgram", pose: tuple[float, ...], speed: float, acceleration: float
) -> Iterator[None]:
    yield from _until_rest(program)
    reachable(program, pose, joints_now(program))
    program.core.arm.move_linear(matrix_from_pose(pose), speed * MM_PER_M, acceleration * MM_PER_M)
    yield from _arrival(program)


def _arrival(program: "ControlProgram") -> Iterator[None]:
    if Fault.FALLS_SHORT in program.core.faults:
        program.core.arm.shorten(_SHORTFALL)
    while program.core.arm.moving:
        yield


def _move(program: "ControlProgram", motion: Iterator[None], asynchronous: bool) -> None:
    program.end_thread()
    if asynchronous:
        program.run_thread(motion)
    else:
        program.block(motion)


def move_joints(program: "ControlProgram") -> None:
    """moveJ."""
    goal, (speed, acceleration) = np.array(program.doubles(0, _JOINTS)), program.doubles(6, 2)
    _move(program, _joint_motion(program, goal, speed, acceleration), bool(program.integer(1)))


def move_joints_to_pose(program: "ControlProgram") -> None:
    """moveJ_IK."""
    goal = reachable(program, program.doubles(0, _POSE), joints_now(program))
    speed, acceleration = program.doubles(6, 2)
    _move(program, _joint_motion(program, goal, speed, acceleration), bool(program.integer(1)))


def move_linear(program: "ControlProgram") -> None:
    """moveL."""
    pose, (speed, acceleration) = program.doubles(0, _POSE), program.doubles(6, 2)
    _move(program, _linear_motion(program, pose, speed, acceleration), bool(program.integer(1)))


def move_linear_to_joints(program: "ControlProgram") -> None:
    """moveL_FK."""
    pose = forward(program, program.doubles(0, _JOINTS), program.core.arm.flange_from_tcp)
    speed, acceleration = program.doubles(6, 2)
    _move(program, _linear_motion(program, pose, speed, acceleration), bool(program.integer(1)))


def _path_motion(program: "ControlProgram") -> Iterator[None]:
    """Blends are not simulated: the arm comes to rest at every waypoint."""
    for index, move in enumerate(program.path):
        program.signal(partial(AsyncStatus.progress, value=index))
        goal = reachable(program, move.target, joints_now(program)) if move.is_pose else np.array(move.target)
        if move.command == "movej":
            yield from _joint_motion(program, goal, move.speed, move.acceleration)
        else:
            pose = forward(program, tuple(goal), program.core.arm.flange_from_tcp)
            yield from _linear_motion(program, pose, move.speed, move.acceleration)


def move_path(program: "ControlProgram") -> None:
    """movePath, with the moves that the client injected into the program."""
    _move(program, _path_motion(program), bool(program.integer(1)))


def _braking(program: "ControlProgram", deceleration: float, along_line: bool) -> Iterator[None]:
    if along_line:
        program.core.arm.brake_linear(deceleration * MM_PER_M)
    else:
        program.core.arm.brake_joints(deceleration)
    while not program.core.arm.at_rest:
        yield
    program.core.arm.drop_motion()


def stop(program: "ControlProgram") -> None:
    """stopL and stopJ share one routine, which takes the kind of stop from the last asynchronous one."""
    (deceleration,) = program.doubles(0, 1)
    program.end_thread()
    if program.integer(1):
        program.stops_along_line = True
        program.run_thread(_braking(program, deceleration, True))
    else:
        program.block(_braking(program, deceleration, program.stops_along_line))


def stop_along_line(program: "ControlProgram") -> None:
    """The stops at the end of speed, servo, force and jog modes."""
    program.end_thread()
    program.block(_braking(program, _LINEAR_STOP_M_S2, True))
