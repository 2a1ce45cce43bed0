"""Faults of the arm and of the guard: raised, each with a stable code of its own."""

from typing import ClassVar


class RobotError(Exception):
    """Base of the package's faults."""

    code: ClassVar[str] = "robot_fault"


class ArmUnreachableError(RobotError):
    """The controller does not answer."""

    code = "arm_unreachable"


class ArmClaimedError(RobotError):
    """Somebody else runs the arm."""

    code = "arm_claimed"


class ControllerRefusedError(RobotError):
    """The controller answered, and not with what was asked."""

    code = "controller_refused"


class GuardDownError(RobotError):
    """No guard process is listening; no motion is possible."""

    code = "guard_down"


class MessageError(RobotError):
    """A line on the guard's pipe is not a message."""

    code = "guard_message_invalid"
