"""The surgeon's part with the arm: a plan, the approval with the PIN, the held button."""

from typing import Any

from coaxial_client import HoldEnded
from simulator.demo.failure import failed_motion
from simulator.demo.patience import patiently
from simulator.demo.results import Moved
from simulator.demo.team import Team

_LONGEST_S = 120.0
_ARRIVED = "arrived"
_SHORTEST_RETREAT_MM = 1.0  # the service plans none shorter


def move(team: Team, kind: str, **goal: Any) -> Moved:
    """One motion, held until it arrives; DemoFailed if it ends otherwise, Refused where it is not allowed.

    After a lost heartbeat a new plan goes on from where the arm stands; what was planned first is returned.
    """
    planned: list[Moved] = []
    left = dict(goal)

    def hold_once() -> None:
        moved, ended = _hold(team, kind, left)
        planned.append(moved)
        if ended.cause != _ARRIVED:
            left.update(_rest_of(left, ended))
            raise failed_motion(kind, ended)

    patiently(team, hold_once)
    team.surgeon.status()
    return planned[0]


def _hold(team: Team, kind: str, goal: dict[str, Any]) -> tuple[Moved, HoldEnded]:
    """Plan, approve, hold: what was planned, and how it ended."""
    team.surgeon.status()
    plan = team.surgeon.plan(kind, **goal)
    detail = plan["detail"]
    what = f"{kind}: {detail['length_mm']:.1f} mm, {detail['rotation_deg']:.2f} deg"
    _tell_detectable(team, detail["detectable_motion"])
    with team.teller.doing(f"{what}, held"), team.surgeon.hold(team.surgeon.approve(plan, team.pin)) as hold:
        ended = hold.wait(_LONGEST_S)
    if ended.cause == _ARRIVED:
        team.teller.tell(f"{what}, held for {detail['duration_s']:.1f} s, arrived")
    return Moved(kind, detail["length_mm"], detail["rotation_deg"]), ended


def _tell_detectable(team: Team, detectable: dict[str, float] | None) -> None:
    """What the surgeon is told before the approval: what the next image will show, and what it may not."""
    if detectable is not None:
        team.teller.tell(
            f"a C-arm or base that moves meanwhile is seen from {detectable['rotation_deg']:.2f} deg, "
            f"{detectable['across_mm']:.1f} mm across, {detectable['along_mm']:.1f} mm along the beam"
        )


def _rest_of(goal: dict[str, Any], ended: HoldEnded) -> dict[str, Any]:
    """Goals are poses, except for a retreat, which counts from where the arm stands."""
    if "distance_mm" not in goal:
        return {}
    return {"distance_mm": max(ended.distance_mm or 0.0, _SHORTEST_RETREAT_MM)}
