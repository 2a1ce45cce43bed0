"""The surgeon's part with the arm: a plan, the approval with the PIN, the held button."""

import time
from typing import Any

from service.client import Case, HoldEnded
from simulator.demo.failure import DemoFailed, failed_motion
from simulator.demo.results import Moved
from simulator.demo.team import Team

_LONGEST_S = 120.0
_ARRIVED, _HEARTBEAT_LOST = "arrived", "heartbeat_lost"
_HOLDS = 3  # a crowded machine loses a heartbeat now and then, as a crowded network would
_CALM_WITHIN_S = 5.0
_LOOK_EVERY_S = 0.1
_SHORTEST_RETREAT_MM = 1.0  # the service plans none shorter


def move(team: Team, kind: str, **goal: Any) -> Moved:
    """One motion, held until it arrives; DemoFailed if it ends otherwise, Refused where it is not allowed.

    A lost heartbeat stops the arm; a surgeon then looks, acknowledges, and approves a new plan from where it stands.
    """
    moved, ended = _hold(team, kind, goal)
    for _ in range(_HOLDS - 1):
        if ended.cause != _HEARTBEAT_LOST:
            break
        team.teller.tell(f"{kind}: the heartbeat was lost, the arm stopped; acknowledged, planned anew")
        _acknowledge(team.surgeon)
        _, ended = _hold(team, kind, _rest_of(goal, ended))
    if ended.cause != _ARRIVED:
        raise failed_motion(kind, ended)
    team.surgeon.status()
    return moved


def _hold(team: Team, kind: str, goal: dict[str, Any]) -> tuple[Moved, HoldEnded]:
    """Plan, approve, hold: what was planned, and how it ended."""
    team.surgeon.status()
    plan = team.surgeon.plan(kind, **goal)
    detail = plan["detail"]
    what = f"{kind}: {detail['length_mm']:.1f} mm, {detail['rotation_deg']:.2f} deg"
    with team.teller.doing(f"{what}, held"), team.surgeon.hold(team.surgeon.approve(plan, team.pin)) as hold:
        ended = hold.wait(_LONGEST_S)
    if ended.cause == _ARRIVED:
        team.teller.tell(f"{what}, held for {detail['duration_s']:.1f} s, arrived")
    return Moved(kind, detail["length_mm"], detail["rotation_deg"]), ended


def _rest_of(goal: dict[str, Any], ended: HoldEnded) -> dict[str, Any]:
    """Goals are poses, except for a retreat, which counts from where the arm stands."""
    if "distance_mm" not in goal:
        return goal
    return {"distance_mm": max(ended.distance_mm or 0.0, _SHORTEST_RETREAT_MM)}


def _acknowledge(surgeon: Case) -> None:
    """Leave the hold as soon as the arm is seen at rest."""
    end_s = time.monotonic() + _CALM_WITHIN_S
    while not (allowance := surgeon.status()["allowed"]["acknowledged"])["allowed"]:
        if time.monotonic() > end_s:
            reasons = "; ".join(f"{reason['code']}: {reason['message']}" for reason in allowance["reasons"])
            raise DemoFailed("not_acknowledged", reasons)
        time.sleep(_LOOK_EVERY_S)
    surgeon.command("acknowledged", guide="empty")
