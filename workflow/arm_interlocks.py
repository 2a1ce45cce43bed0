"""Interlocks of the arm, the guard and the hand on the button, judged from the snapshot."""

import math

from workflow.checks import Interlock, joints_near, reads, reads_within, young
from workflow.findings import Finding, age_note, fresh, is_true
from workflow.inquiry import Inquiry
from workflow.limits import Limits
from workflow.snapshot import SafetyMode
from workflow.triggers import Trigger

_MAY_MOVE = (SafetyMode.NORMAL, SafetyMode.REDUCED)


def _feedback_age(limits: Limits) -> float:
    return limits.feedback_age_s


def _heartbeat_age(limits: Limits) -> float:
    return limits.heartbeat_age_s


def _record_age(limits: Limits) -> float:
    return limits.record_age_s


def _safety_normal(inquiry: Inquiry) -> Finding:
    reading, age_s = inquiry.snapshot.safety_mode, inquiry.limits.feedback_age_s
    mode = fresh(reading, age_s)
    return Finding(mode in _MAY_MOVE, mode, "normal or reduced", note=age_note(reading, age_s))


def _feedback_finite(inquiry: Inquiry) -> Finding:
    snapshot = inquiry.snapshot
    joints, time_s = snapshot.joints_rad.value, snapshot.controller_time_s.value
    if joints is None or time_s is None:
        return is_true(None)
    return is_true(all(map(math.isfinite, (*joints, time_s))))


AT_REST = Interlock("at_rest", "H04", "the arm is not at rest", reads(lambda s: s.at_rest, True, _feedback_age))
UNACCOUNTED_MM = Interlock(
    "unaccounted_mm",
    "H04",
    "the guide was moved by something else than a commanded motion",
    reads_within(lambda s: s.unaccounted_mm, _feedback_age, lambda limits: limits.unaccounted_mm, "mm"),
    (Trigger.RETAKE,),
)
UNACCOUNTED_RAD = Interlock(
    "unaccounted_rad",
    "H04",
    "the guide was turned by something else than a commanded motion",
    reads_within(lambda s: s.unaccounted_rad, _feedback_age, lambda limits: limits.unaccounted_rad, "rad"),
    (Trigger.RETAKE,),
)
ARM_WHERE_PLANNED = Interlock(
    "arm_where_planned",
    "H04",
    "the arm is not where the plan starts",
    joints_near(lambda inquiry: inquiry.plan.start_joints_rad if inquiry.plan else None),
    (Trigger.PLAN_REQUESTED,),
)
DEVICES_IN_DATE = Interlock(
    "devices_in_date",
    "H10",
    "a device file has expired",
    reads(lambda s: s.devices_in_date, True, _record_age),
    (Trigger.DEVICE_CHANGED,),
)
TCP_MM = Interlock(
    "tcp_mm",
    "H10",
    "the controller's TCP is shifted against the tool file",
    reads_within(lambda s: s.tcp_difference_mm, _record_age, lambda limits: limits.tcp_difference_mm, "mm"),
    (Trigger.DEVICE_CHANGED,),
)
TCP_RAD = Interlock(
    "tcp_rad",
    "H10",
    "the controller's TCP is turned against the tool file",
    reads_within(lambda s: s.tcp_difference_rad, _record_age, lambda limits: limits.tcp_difference_rad, "rad"),
    (Trigger.DEVICE_CHANGED,),
)
PAYLOAD_KG = Interlock(
    "payload_kg",
    "H10",
    "the controller's payload is not that of the tool file",
    reads_within(lambda s: s.payload_difference_kg, _record_age, lambda limits: limits.payload_difference_kg, "kg"),
    (Trigger.DEVICE_CHANGED,),
)
HOLD_PRESSED = Interlock(
    "hold_pressed",
    "H13",
    "the button is not held",
    lambda inquiry: is_true(inquiry.snapshot.hold_pressed.value),
    asks=True,
)
HEARTBEAT_FRESH = Interlock(
    "heartbeat_fresh",
    "H16",
    "no heartbeat from the tablet",
    young(lambda s: s.hold_pressed, _heartbeat_age),
    asks=True,
)
GUARD_ALIVE = Interlock(
    "guard_alive", "H17", "the guard process does not answer", reads(lambda s: s.guard_alive, True, _heartbeat_age)
)
SAFETY_NORMAL = Interlock("safety_normal", "H18", "the controller's safety system has stopped the arm", _safety_normal)
FEEDBACK_FRESH = Interlock(
    "feedback_fresh", "H21", "the arm's feedback is old", young(lambda s: s.controller_time_s, _feedback_age)
)
JOINTS_FRESH = Interlock(
    "joints_fresh", "H21", "the arm's joints were not read again", young(lambda s: s.joints_rad, _feedback_age)
)
FEEDBACK_FINITE = Interlock("feedback_finite", "H21", "the arm's feedback is not a number", _feedback_finite)
FEEDBACK_ADVANCES = Interlock(
    "feedback_advances",
    "H21",
    "the controller's clock does not advance",
    reads(lambda s: s.feedback_advances, True, _feedback_age),
)
SCRIPT_STOPPED = Interlock(
    "script_stopped",
    "H29",
    "a program runs on the controller",
    reads(lambda s: s.program_running, False, _feedback_age),
)
MOTION_LOCKED = Interlock(
    "motion_locked", "H29", "the guard does not lock the arm", reads(lambda s: s.motion_locked, True, _heartbeat_age)
)
DRIFT_MM = Interlock(
    "drift_mm",
    "H29",
    "the guide is not where it was verified",
    reads_within(lambda s: s.drift_mm, _feedback_age, lambda limits: limits.drift_mm, "mm"),
    (Trigger.VERIFICATION_REJECTED,),
)
DRIFT_RAD = Interlock(
    "drift_rad",
    "H29",
    "the guide is not turned as it was verified",
    reads_within(lambda s: s.drift_rad, _feedback_age, lambda limits: limits.drift_rad, "rad"),
    (Trigger.VERIFICATION_REJECTED,),
)
CHALLENGE_ECHOED = Interlock(
    "challenge_echoed",
    "H36",
    "the heartbeat does not echo the guard's challenge",
    lambda inquiry: is_true(inquiry.snapshot.challenge_echoed.value),
    asks=True,
)
CHALLENGE_FRESH = Interlock(
    "challenge_fresh",
    "H36",
    "the heartbeat echoes an old challenge",
    young(lambda s: s.challenge_echoed, _heartbeat_age),
    asks=True,
)
