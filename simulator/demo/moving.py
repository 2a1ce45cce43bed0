"""The surgeon's part with the arm: a plan, the approval with the PIN, the held button."""

from typing import Any

from simulator.demo.failure import failed_motion
from simulator.demo.results import Moved
from simulator.demo.team import Team

_LONGEST_S = 120.0
_ARRIVED = "arrived"


def move(team: Team, kind: str, **goal: Any) -> Moved:
    """One motion, held until it arrives; DemoFailed if it ends otherwise, Refused where it is not allowed."""
    surgeon = team.surgeon
    surgeon.status()
    plan = surgeon.plan(kind, **goal)
    detail = plan["detail"]
    moved = Moved(kind, detail["length_mm"], detail["rotation_deg"])
    what = f"{kind}: {moved.translation_mm:.1f} mm, {moved.rotation_deg:.2f} deg"
    with team.teller.doing(f"{what}, held"), surgeon.hold(surgeon.approve(plan, team.pin)) as hold:
        ended = hold.wait(_LONGEST_S)
    if ended.cause != _ARRIVED:
        raise failed_motion(kind, ended)
    surgeon.status()
    team.teller.tell(f"{what} in {detail['duration_s']:.1f} s, {ended.cause} within {ended.distance_mm:.3f} mm")
    return moved
