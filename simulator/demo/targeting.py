"""One target: from the C-arm's view to the sleeve, with as many corrections as the limits ask for."""

import numpy as np

from simulator.demo.door_client import Door
from simulator.demo.failure import DemoFailed, SeenToMoveError
from simulator.demo.imaging import stand_again, take_registration, take_verification, turn_carm
from simulator.demo.legs import legs
from simulator.demo.moving import move
from simulator.demo.patience import patiently
from simulator.demo.results import Moved, TargetResult, Verified
from simulator.demo.team import Team
from simulator.demo.watching import Json

_ECHO_WITHIN_PX = 0.5  # H08
_CORRECTIONS = 3
_REGISTRATIONS = 3  # for one target
_CLEARANCE_MM = 45.0  # along the guide's axis, before the C-arm turns: above the skin, below the intensifier


def place_sleeve(team: Team, pedicle: str) -> TargetResult:
    """The whole procedure for one planned pedicle; DemoFailed or Refused where it does not go on."""
    started_s, images = team.teller.elapsed_s(), int(team.operator.status()["images"])
    bring_guide_in(team, pedicle)
    moved, verified = _bring_onto_target(team, pedicle)
    _insert(team)
    move(team, "retreat", distance_mm=_CLEARANCE_MM)
    exposures = int(team.operator.status()["images"]) - images
    return TargetResult(pedicle, moved, verified, exposures, team.teller.elapsed_s() - started_s)


def bring_guide_in(team: Team, pedicle: str) -> None:
    """C-arm into the view, guide stated empty, arm into the beam by eye."""
    turn_carm(team, pedicle)
    team.operator.command("guide-state-stated", guide="empty")
    start = np.array(team.surgeon.status()["arm"]["base_from_tcp"])
    for goal in legs(start, team.door.approach_to(pedicle)):
        move(team, "approach", base_from_goal=goal)


def _bring_onto_target(team: Team, pedicle: str) -> tuple[tuple[Moved, ...], tuple[Verified, ...]]:
    """Register, choose, move, verify; all of it anew where the verification's image shows that something moved."""
    for _ in range(_REGISTRATIONS - 1):
        try:
            return _registered_and_aimed(team, pedicle)
        except SeenToMoveError as seen:
            team.teller.tell(f"registered anew: {seen}")
            stand_again(team)
    return _registered_and_aimed(team, pedicle)


def _registered_and_aimed(team: Team, pedicle: str) -> tuple[tuple[Moved, ...], tuple[Verified, ...]]:
    _choose_target(team, pedicle)
    return _aim(team, pedicle)


def _choose_target(team: Team, pedicle: str) -> None:
    """Register, tap what the surgeon sees, look at what the service understood, confirm."""
    image_id = take_registration(team)["data"]["image_id"]
    pixel_px = team.door.pixel_of(pedicle)
    team.surgeon.status()
    echo = team.surgeon.echo(image_id, pixel_px)
    off_px = max(abs(seen - tapped) for seen, tapped in zip(echo["raw_px"], pixel_px, strict=True))
    if off_px > _ECHO_WITHIN_PX:
        raise DemoFailed("echo_elsewhere", f"drawn back {off_px:.2f} px from where it was tapped")
    answer = team.surgeon.command("target-confirmed", echo_id=echo["echo_id"], planned_target=pedicle)
    predicted = answer["detail"]["targeting"]["predicted_error_95"]
    team.teller.tell(
        f"target at ({pixel_px[0]:.1f}, {pixel_px[1]:.1f}) px, echo seen and confirmed, "
        f"predicted within {predicted['angle_deg']:.3f} deg and {predicted['position_mm']:.3f} mm"
    )


def _aim(team: Team, pedicle: str) -> tuple[tuple[Moved, ...], tuple[Verified, ...]]:
    """Move and verify, then correct from the verification image, until error and bound are within the limits."""
    moved = [move(team, "targeting")]
    verified = [_verify(team, pedicle)]
    while not verified[-1].passed:
        if len(moved) > _CORRECTIONS:
            raise DemoFailed("off_target", f"{pedicle} is still off after {_CORRECTIONS} corrections")
        patiently(team, lambda: _correct(team))
        moved.append(move(team, "corrective"))
        verified.append(_verify(team, pedicle))
    return tuple(moved), tuple(verified)


def _correct(team: Team) -> None:
    team.surgeon.status()
    team.surgeon.command("correction-requested", reason="error and bound exceed the limits")


def _verify(team: Team, pedicle: str) -> Verified:
    event = take_verification(team)
    result = _figures(event, team.door, pedicle)
    team.teller.tell(
        f"{event['state']}: {result.contour_deg:.3f} deg and {result.contour_mm:.3f} mm "
        f"(bounds {result.bound_deg:.3f}, {result.bound_mm:.3f}); "
        f"paper {result.paper_deg:.3f}, {result.paper_mm:.3f}; true {result.true.angle_deg:.3f}, "
        f"{result.true.position_mm:.3f}"
    )
    return result


def _figures(event: Json, door: Door, pedicle: str) -> Verified:
    contour, paper = event["data"]["contour"], event["data"]["paper"]
    bounds = contour["predicted_error_95"]
    return Verified(
        passed=event["state"] == "verified",
        contour_deg=contour["angle_error_deg"],
        contour_mm=contour["position_error_mm"],
        bound_deg=bounds["angle_deg"],
        bound_mm=bounds["position_mm"],
        paper_deg=paper["angle_error_deg"],
        paper_mm=paper["position_error_mm"],
        true=door.true_error(pedicle),
    )


def _start_insertion(team: Team) -> None:
    team.surgeon.status()
    team.surgeon.command("insertion-started", pin=team.pin)


def _insert(team: Team) -> None:
    """The arm locked, the sleeve in, the sleeve out: the guide is empty again."""
    patiently(team, lambda: _start_insertion(team))
    team.operator.command("sleeve-in")
    team.operator.command("sleeve-removed", guide="empty")
    alarms = team.surgeon.status()["alarms"]
    if alarms:
        raise DemoFailed(alarms[0], "something moved while the sleeve was in")
    team.surgeon.command("target-done", placed=True)
    team.teller.tell("arm locked, sleeve in, wire placed, sleeve out, guide stated empty, target done")
