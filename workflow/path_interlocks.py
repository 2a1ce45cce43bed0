"""Interlocks of a plan's path: the arm's own limits (H11), and what it may come near to, how far and how fast (H12)."""

from collections.abc import Callable

from workflow.checks import Interlock, bounded, enough, given
from workflow.facts import PlanRequested
from workflow.findings import Finding, at_least
from workflow.inquiry import Inquiry


def _planned(value: Callable[[PlanRequested], float | None]) -> Callable[[Inquiry], float | None]:
    return given(PlanRequested, value)


def _clearance(inquiry: Inquiry) -> Finding:
    """As much as the room file asks; only a retreat along the axis may begin nearer, and asks for less."""
    plan, floor_mm = inquiry.given(PlanRequested), inquiry.limits.clearance_mm
    if plan is None or plan.clearance_needed_mm is None:
        return at_least(None, floor_mm, "mm")
    needed_mm = plan.clearance_needed_mm if plan.axial else max(plan.clearance_needed_mm, floor_mm)
    return at_least(plan.clearance_mm, needed_mm, "mm")


JOINT_MARGIN = Interlock(
    "joint_margin",
    "H11",
    "a joint comes too near its limit",
    enough(_planned(lambda p: p.joint_margin_rad), lambda limits: limits.joint_margin_rad, "rad"),
    asks=True,
)
SINGULARITY = Interlock(
    "singularity",
    "H11",
    "the path comes too near a singularity",
    enough(_planned(lambda p: p.smallest_singular_value), lambda limits: limits.smallest_singular_value, ""),
    asks=True,
)
CLEARANCE = Interlock("clearance", "H12", "the arm comes too near to something in the room", _clearance, asks=True)
PATH_LENGTH = Interlock(
    "path_length",
    "H12",
    "the way is too long for one motion",
    bounded(_planned(lambda p: p.length_mm), lambda limits: limits.path_length_mm, "mm"),
    asks=True,
)
PATH_ANGLE = Interlock(
    "path_angle",
    "H12",
    "the turn is too large for one motion",
    bounded(_planned(lambda p: p.rotation_rad), lambda limits: limits.path_angle_rad, "rad"),
    asks=True,
)
PATH_SPEED = Interlock(
    "path_speed",
    "H12",
    "the motion is too fast",
    bounded(_planned(lambda p: p.speed_mm_s), lambda limits: limits.speed_mm_s, "mm/s"),
    asks=True,
)
PATH_TURN_SPEED = Interlock(
    "path_turn_speed",
    "H12",
    "the motion turns too fast",
    bounded(_planned(lambda p: p.speed_rad_s), lambda limits: limits.speed_rad_s, "rad/s"),
    asks=True,
)
PATH_ACCELERATION = Interlock(
    "path_acceleration",
    "H12",
    "the motion starts and ends too abruptly",
    bounded(_planned(lambda p: p.acceleration_mm_s2), lambda limits: limits.acceleration_mm_s2, "mm/s2"),
    asks=True,
)
ALL = (
    JOINT_MARGIN,
    SINGULARITY,
    CLEARANCE,
    PATH_LENGTH,
    PATH_ANGLE,
    PATH_SPEED,
    PATH_TURN_SPEED,
    PATH_ACCELERATION,
)
