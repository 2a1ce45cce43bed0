"""What the world refused: returned, never raised."""

from dataclasses import dataclass
from enum import StrEnum
from math import isfinite


class RefusalCode(StrEnum):
    """Stable reasons of `plan_path` and of the guard; documented with their limits where they are decided."""

    # plan_path
    GOAL_UNREACHABLE = "goal_unreachable"
    JOINT_LIMIT = "joint_limit"
    NEAR_SINGULARITY = "near_singularity"
    JOINT_JUMP = "joint_jump"
    JOINT_SPEED = "joint_speed"
    PATH_TOO_LONG = "path_too_long"
    MODEL_MISMATCH = "model_mismatch"
    KEEP_OUT = "keep_out"
    # calibrate
    TOO_FEW_POSES = "too_few_poses"
    POSES_TOO_ALIKE = "poses_too_alike"
    POSES_INCONSISTENT = "poses_inconsistent"
    # guard, before a motion
    GUARD_HELD = "guard_held"
    MOTION_RUNNING = "motion_running"
    PERMIT_REUSED = "permit_reused"
    NO_LIVE_HEARTBEAT = "no_live_heartbeat"
    FEEDBACK_LATE = "feedback_late"
    ARM_UNREACHABLE = "arm_unreachable"
    ARM_NOT_READY = "arm_not_ready"
    ARM_NOT_AT_REST = "arm_not_at_rest"
    ARM_MOVED_SINCE_PERMIT = "arm_moved_since_permit"
    TCP_MISMATCH = "tcp_mismatch"
    PAYLOAD_MISMATCH = "payload_mismatch"
    FORCE_AT_REST = "force_at_rest"
    SPEED_ABOVE_CAP = "speed_above_cap"
    ACCELERATION_ABOVE_CAP = "acceleration_above_cap"
    MOVE_TOO_FAR = "move_too_far"
    STOPPED = "stopped"
    JOURNAL_UNWRITABLE = "journal_unwritable"
    CONTROLLER_REFUSED = "controller_refused"


@dataclass(frozen=True, slots=True)
class Refusal:
    """A refusal with what was measured and the limit, in the unit that the message names.

    What is no finite number was not measured: a message to the service could not hold it.
    """

    code: RefusalCode
    message: str
    measured: float | None
    limit: float | None

    def __post_init__(self) -> None:
        if self.measured is not None and not isfinite(self.measured):
            object.__setattr__(self, "measured", None)
