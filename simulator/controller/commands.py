"""The command numbers of the control program."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from simulator.controller import moves, questions

if TYPE_CHECKING:
    from simulator.controller.program import ControlProgram

Handler = Callable[["ControlProgram"], None]

# Run every cycle while requested; 6, 9, 10, 11, 24 (forces, speeds, servoing) and 66 to 71 are not simulated.
REALTIME = frozenset({6, 9, 10, 11, 24, 25, 26, 27, 38, 58, *range(66, 72)})


def _arm_watchdog(program: "ControlProgram") -> None:
    (program.core.watchdog.frequency_hz,) = program.doubles(0, 1)


def _stop_protectively(program: "ControlProgram") -> None:
    program.core.stop_protectively()


def _tell_cycle(program: "ControlProgram") -> None:
    program.result((program.core.settings.cycle_s,))


def _tell_no_torques(program: "ControlProgram") -> None:
    program.result((0.0,) * 6)


def _nothing(program: "ControlProgram") -> None:
    """Accepted without an effect: force sensor, gravity, teach and freedrive modes of an arm nobody touches."""
    del program


COMMANDS: dict[int, Handler] = {
    1: moves.move_joints,
    2: moves.move_joints_to_pose,
    3: moves.move_linear,
    4: moves.move_linear_to_joints,
    7: moves.stop_along_line,
    8: _nothing,
    15: moves.stop_along_line,
    16: moves.stop_along_line,
    17: questions.set_payload,
    18: _nothing,
    19: _nothing,
    26: _tell_cycle,
    27: questions.tell_joints,
    28: questions.tell_pose,
    29: questions.set_tcp,
    30: questions.tell_inverse_near,
    31: _stop_protectively,
    33: moves.stop,
    34: moves.stop,
    35: _arm_watchdog,
    36: questions.tell_has_inverse,
    37: questions.tell_joints_allowed,
    38: _tell_no_torques,
    39: questions.tell_composed,
    40: questions.tell_tcp,
    42: moves.stop_along_line,
    43: questions.tell_pose,
    44: questions.tell_forward,
    45: moves.move_path,
    46: questions.tell_inverse,
    47: questions.tell_steady,
    52: _nothing,
    53: _nothing,
    58: questions.tell_flange_pose,
    59: _nothing,
    60: questions.tell_has_inverse,
    61: questions.tell_has_inverse_near,
}
