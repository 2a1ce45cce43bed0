"""Going on after a hold that only a crowded machine caused: looked at, acknowledged, the step done anew."""

import time
from collections.abc import Callable
from typing import TypeVar

from coaxial_client import Refused
from simulator.demo.failure import DemoFailed
from simulator.demo.team import Team

_Result = TypeVar("_Result")
# Links that lost a few of many messages a second; whatever else stops the arm ends the run.
_LOST_LINKS = ("heartbeat_lost", "feedback_lost")
HELD = "safe_hold"
_STALE = "H21"
_TRIES = 4
_TOLD_WITHIN_S = 1.0
_CALM_WITHIN_S = 10.0
_LOOK_EVERY_S = 0.1


def patiently(team: Team, step: Callable[[], _Result]) -> _Result:
    """The step's result, done again where a link was lost; DemoFailed or Refused for everything else."""
    for _ in range(_TRIES - 1):
        try:
            return step()
        except (DemoFailed, Refused) as error:
            lost = _lost_link(team, error)
            if lost is None:
                raise
        team.teller.tell(f"{lost}: the arm was held; looked at, acknowledged, done anew")
    return step()


def leave_hold(team: Team) -> str:
    """Acknowledge a hold that a lost link caused: the state that the case settles in; DemoFailed for another cause."""
    held_for = str(team.surgeon.status()["held_for"])
    if held_for not in _LOST_LINKS:
        raise DemoFailed(held_for, "the case is held")
    team.teller.tell(f"{held_for}: the arm was held; looked at, acknowledged")
    _acknowledged(team, held_for)
    return str(team.surgeon.status()["state"])


def _lost_link(team: Team, error: DemoFailed | Refused) -> str | None:
    """The lost link that held the case, which is acknowledged then; or that a reading was late; None otherwise."""
    end_s = time.monotonic() + _TOLD_WITHIN_S  # the refusal comes before the fault is in the record
    while time.monotonic() < end_s:
        status = team.surgeon.status()
        if status["state"] == HELD:
            held_for = str(status["held_for"])
            return _acknowledged(team, held_for) if held_for in _LOST_LINKS else None
        time.sleep(_LOOK_EVERY_S)
    late = isinstance(error, Refused) and any(one["hazard"] == _STALE and not one["passed"] for one in error.verdicts)
    return "feedback_late" if late else None


def _acknowledged(team: Team, held_for: str) -> str:
    """Leave the hold as soon as the arm is seen at rest."""
    end_s = time.monotonic() + _CALM_WITHIN_S
    while not (allowance := team.surgeon.status()["allowed"]["acknowledged"])["allowed"]:
        if time.monotonic() > end_s:
            reasons = "; ".join(f"{reason['code']}: {reason['message']}" for reason in allowance["reasons"])
            raise DemoFailed(held_for, f"the hold cannot be left: {reasons}")
        time.sleep(_LOOK_EVERY_S)
    team.surgeon.command("acknowledged", guide="empty")
    return held_for
