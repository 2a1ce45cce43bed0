"""What the control program does for each command number (metres, radians and seconds as on the wire)."""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simulator import kinematics
from simulator.controller.poses import MM_PER_M, inverse, matrix_from_pose, pose_from_matrix
from simulator.controller.settings import Payload
from simulator.controller.states import Fault

if TYPE_CHECKING:
    from simulator.controller.program import ControlProgram

Array = NDArray[np.float64]

JOINTS, POSE = 6, 6
_LINEAR_STOP_M_S2 = 10.0
_SHORTFALL = 0.9  # of the way, where a motion that falls short ends


class ProgramError(RuntimeError):
    """The script would have failed here; the controller stops it."""


def _inverse_kinematics(program: "ControlProgram", pose: tuple[float, ...], near: tuple[float, ...]) -> Array | None:
    arm = program.core.arm
    goal = matrix_from_pose(pose) @ inverse(arm.flange_from_tcp)
    return kinematics.solve_joints(arm.nominal, goal, np.array(near))


def _forward_kinematics(program: "ControlProgram", joints: tuple[float, ...], tcp: Array) -> tuple[float, ...]:
    return pose_from_matrix(kinematics.base_from_flange(program.core.arm.nominal, np.array(joints)) @ tcp)


def _reachable(program: "ControlProgram", pose: tuple[float, ...], near: tuple[float, ...]) -> Array:
    joints = _inverse_kinematics(program, pose, near)
    if joints is None:
        raise ProgramError("inverse kinematics has no solution")
    return joints


def _present(program: "ControlProgram") -> tuple[float, ...]:
    return tuple(program.core.arm.joints_rad.tolist())


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
    _reachable(program, pose, _present(program))
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


def _move_joints(program: "ControlProgram") -> None:
    goal, (speed, acceleration) = np.array(program.doubles(0, JOINTS)), program.doubles(6, 2)
    _move(program, _joint_motion(program, goal, speed, acceleration), bool(program.integer(1)))


def _move_joints_to_pose(program: "ControlProgram") -> None:
    goal, (speed, acceleration) = (
        _reachable(program, program.doubles(0, POSE), _present(program)),
        program.doubles(6, 2),
    )
    _move(program, _joint_motion(program, goal, speed, acceleration), bool(program.integer(1)))


def _move_linear(program: "ControlProgram") -> None:
    pose, (speed, acceleration) = program.doubles(0, POSE), program.doubles(6, 2)
    _move(program, _linear_motion(program, pose, speed, acceleration), bool(program.integer(1)))


def _move_linear_to_joints(program: "ControlProgram") -> None:
    pose = _forward_kinematics(program, program.doubles(0, JOINTS), program.core.arm.flange_from_tcp)
    speed, acceleration = program.doubles(6, 2)
    _move(program, _linear_motion(program, pose, speed, acceleration), bool(program.integer(1)))


def _path_motion(program: "ControlProgram") -> Iterator[None]:
    """Blends are not simulated: the arm comes to rest at every waypoint."""
    for index, move in enumerate(program.path):
        program.signal(lambda status, index=index: status.progress(index))  # type: ignore[misc]  # bound now
        goal = _reachable(program, move.target, _present(program)) if move.is_pose else np.array(move.target)
        if move.command == "movej":
            yield from _joint_motion(program, goal, move.speed, move.acceleration)
        else:
            pose = _forward_kinematics(program, tuple(goal), program.core.arm.flange_from_tcp)
            yield from _linear_motion(program, pose, move.speed, move.acceleration)


def _move_path(program: "ControlProgram") -> None:
    _move(program, _path_motion(program), bool(program.integer(1)))


def _braking(program: "ControlProgram", deceleration: float, along_line: bool) -> Iterator[None]:
    if along_line:
        program.core.arm.brake_linear(deceleration * MM_PER_M)
    else:
        program.core.arm.brake_joints(deceleration)
    while not program.core.arm.at_rest:
        yield
    program.core.arm.drop_motion()


def _stop(program: "ControlProgram") -> None:
    """stopL and stopJ share one routine, which takes the kind of stop from the last asynchronous one."""
    (deceleration,) = program.doubles(0, 1)
    program.end_thread()
    if program.integer(1):
        program.stops_along_line = True
        program.run_thread(_braking(program, deceleration, True))
    else:
        program.block(_braking(program, deceleration, program.stops_along_line))


def _stop_along_line(program: "ControlProgram") -> None:
    program.end_thread()
    program.block(_braking(program, _LINEAR_STOP_M_S2, True))


def _set_payload(program: "ControlProgram") -> None:
    mass, x, y, z = program.doubles(0, 4)
    program.core.payload = Payload(mass, (x * MM_PER_M, y * MM_PER_M, z * MM_PER_M))


def _set_tcp(program: "ControlProgram") -> None:
    program.core.arm.flange_from_tcp = matrix_from_pose(program.doubles(0, POSE))


def _tcp_offset(program: "ControlProgram") -> None:
    program.result(pose_from_matrix(program.core.arm.flange_from_tcp))


def _inverse(program: "ControlProgram") -> None:
    program.result(tuple(_reachable(program, program.doubles(0, POSE), _present(program))))


def _inverse_near(program: "ControlProgram") -> None:
    program.result(tuple(_reachable(program, program.doubles(0, POSE), program.doubles(6, JOINTS))))


def _has_inverse(program: "ControlProgram") -> None:
    program.verdict(_inverse_kinematics(program, program.doubles(0, POSE), _present(program)) is not None)


def _has_inverse_near(program: "ControlProgram") -> None:
    solution = _inverse_kinematics(program, program.doubles(0, POSE), program.doubles(6, JOINTS))
    program.verdict(solution is not None)


def _joints_allowed(program: "ControlProgram") -> None:
    program.verdict(bool(np.all(np.abs(program.doubles(0, JOINTS)) <= kinematics.JOINT_LIMIT_RAD)))


def _forward(program: "ControlProgram") -> None:
    program.result(pose_from_matrix(program.core.arm.base_from_tcp))


def _forward_of(program: "ControlProgram") -> None:
    program.result(_forward_kinematics(program, program.doubles(0, JOINTS), matrix_from_pose(program.doubles(6, POSE))))


def _compose(program: "ControlProgram") -> None:
    first, second = matrix_from_pose(program.doubles(0, POSE)), matrix_from_pose(program.doubles(6, POSE))
    program.result(pose_from_matrix(first @ second))


def _steady(program: "ControlProgram") -> None:
    program.verdict(program.core.arm.at_rest)


def _watchdog(program: "ControlProgram") -> None:
    (program.core.watchdog.frequency_hz,) = program.doubles(0, 1)


def _protective_stop(program: "ControlProgram") -> None:
    program.core.stop_protectively()


def _target_waypoint(program: "ControlProgram") -> None:
    program.result(pose_from_matrix(program.core.arm.base_from_tcp))


def _flange_pose(program: "ControlProgram") -> None:
    program.result(pose_from_matrix(program.core.arm.base_from_flange))


def _step_time(program: "ControlProgram") -> None:
    program.result((program.core.settings.cycle_s,))


def _joints_before(program: "ControlProgram") -> None:
    program.result(_present(program))


def _joint_torques(program: "ControlProgram") -> None:
    program.result((0.0,) * JOINTS)


def _nothing(program: "ControlProgram") -> None:
    """Accepted without an effect: force sensor, gravity, teach and freedrive modes of an arm nobody touches."""
    del program


Handler = Callable[["ControlProgram"], None]

# Run every cycle while requested; 6, 9, 10, 11, 24 (forces, speeds, servoing) and 66 to 71 are not simulated.
REALTIME = frozenset({6, 9, 10, 11, 24, 25, 26, 27, 38, 58, *range(66, 72)})

COMMANDS: dict[int, Handler] = {
    1: _move_joints,
    2: _move_joints_to_pose,
    3: _move_linear,
    4: _move_linear_to_joints,
    7: _stop_along_line,
    8: _nothing,
    15: _stop_along_line,
    16: _stop_along_line,
    17: _set_payload,
    18: _nothing,
    19: _nothing,
    26: _step_time,
    27: _joints_before,
    28: _target_waypoint,
    29: _set_tcp,
    30: _inverse_near,
    31: _protective_stop,
    33: _stop,
    34: _stop,
    35: _watchdog,
    36: _has_inverse,
    37: _joints_allowed,
    38: _joint_torques,
    39: _compose,
    40: _tcp_offset,
    42: _stop_along_line,
    43: _forward,
    44: _forward_of,
    45: _move_path,
    46: _inverse,
    47: _steady,
    52: _nothing,
    53: _nothing,
    58: _flange_pose,
    59: _nothing,
    60: _has_inverse,
    61: _has_inverse_near,
}
