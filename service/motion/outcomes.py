"""What the guard saw, in the words of the rules."""

from robot.guard.messages import EndCause, FaultKind, MotionEnded
from workflow.facts import Faulted
from workflow.facts import FaultKind as Kind
from workflow.facts import MotionEnded as MotionOver
from workflow.triggers import Trigger

_CALM = {
    EndCause.ARRIVED: Trigger.ARRIVED,
    EndCause.MISSED: Trigger.MISSED,
    EndCause.RELEASED: Trigger.RELEASED,
}
_FAULTS = {
    EndCause.HEARTBEAT_LOST: Kind.HEARTBEAT_LOST,
    EndCause.FEEDBACK_LOST: Kind.FEEDBACK_LOST,
    EndCause.PARENT_LOST: Kind.GUARD_LOST,
    EndCause.OVERSPEED: Kind.MOTION_FAULT,
    EndCause.NOT_STARTED: Kind.MOTION_FAULT,
    EndCause.OVERDUE: Kind.MOTION_FAULT,
    EndCause.CONTROL_LOST: Kind.MOTION_FAULT,
    EndCause.OFF_PATH: Kind.MOTION_FAULT,
    EndCause.FORCE_RISE: Kind.FORCE_RISE,
    EndCause.TCP_CHANGED: Kind.INSTALLATION_CHANGED,
    EndCause.PAYLOAD_CHANGED: Kind.INSTALLATION_CHANGED,
    EndCause.PROTECTIVE_STOP: Kind.PROTECTIVE_STOP,
    EndCause.SAFEGUARD_STOP: Kind.SAFEGUARD_STOP,
    EndCause.EMERGENCY_STOP: Kind.EMERGENCY_STOP,
    EndCause.SAFETY_FAULT: Kind.SAFETY_FAULT,
    EndCause.ARM_OFF: Kind.ARM_OFF,
}


def outcome_of(ended: MotionEnded, motion_id: str) -> tuple[Trigger, MotionOver | Faulted] | None:
    """The observation that an end amounts to; None for a motion that a person stopped, whose stop is recorded."""
    calm = _CALM.get(ended.cause)
    if calm is not None and (ended.program_stopped or not ended.at_rest):
        return calm, MotionOver(motion_id, ended.at_rest, ended.distance_mm, ended.angle_rad)
    fault = _FAULTS.get(ended.cause) if calm is None else Kind.MOTION_FAULT  # at rest, and its program would not stop
    return None if fault is None else (Trigger.FAULT, Faulted(fault))


def fault_of(kind: FaultKind) -> Faulted:
    """A fault without a motion."""
    return Faulted(Kind(kind.value))
