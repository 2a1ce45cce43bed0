"""The radiographer's part: the C-arm turned and confirmed, exposures requested and made."""

from coaxial_client import Case
from simulator.demo.failure import DemoFailed, SeenToMoveError, measured
from simulator.demo.patience import HELD, leave_hold, patiently
from simulator.demo.team import Team
from simulator.demo.watching import Json, await_event, why

_RESULT_WITHIN_S = 120.0  # the service has a deadline of its own
_TAKES = 2  # exposures for one result
_REGISTRATION = ("registration_completed", "registration_refused")
_MOVED = ("carm_moved", "patient_moved")
_VERIFICATION = ("verification_passed", "verification_failed", "verification_refused", *_MOVED)


def turn_carm(team: Team, pedicle: str) -> None:
    """Into the view in which the planned path projects to a point; what was seen from elsewhere is void."""
    operator = team.operator
    angles = operator.carm_angles(pedicle)
    primary_deg, secondary_deg = angles["primary_angle_deg"], angles["secondary_angle_deg"]
    operator.command("carm-moved", what=f"view for {pedicle}")
    with team.teller.doing("the C-arm turns"):
        team.door.position_carm(primary_deg, secondary_deg, pedicle)
    patiently(team, lambda: _confirm_position(operator))
    team.teller.tell(f"C-arm at {primary_deg:.1f} / {secondary_deg:.1f} deg: {angles['words']}")


def stand_again(team: Team) -> None:
    """The C-arm stands as it is now."""
    if team.operator.status()["state"] == "case_open":
        patiently(team, lambda: _confirm_position(team.operator))


def _confirm_position(operator: Case) -> None:
    operator.status()
    operator.command("carm-position-confirmed")


def take_registration(team: Team) -> Json:
    """An exposure, and the guide found in it: the event with what the registration says of itself; DemoFailed."""
    event = _usable(team, _REGISTRATION, "carm_positioned")
    data = event["data"]
    predicted = data["predicted_error_95"]
    team.teller.tell(
        f"registered: residual {data['residual_rms_px']:.3f} px, {data['balls']} balls, "
        f"predicted within {predicted['angle_deg']:.3f} deg and {predicted['position_mm']:.3f} mm"
    )
    return event


def take_verification(team: Team) -> Json:
    """An exposure after a motion, and its evaluation: the event with both figures; SeenToMoveError, DemoFailed."""
    event = _usable(team, _VERIFICATION, "moved")
    if event["trigger"] in _MOVED:
        raise SeenToMoveError(event["trigger"], why(team.surgeon, event["data"]["told_as"]))
    return event


def _usable(team: Team, wanted: tuple[str, ...], refused_in: str) -> Json:
    """The result of an exposure, of another one where an image was refused; DemoFailed with the last reason."""
    for take in range(1, _TAKES + 1):
        event = patiently(team, lambda: _expose(team, wanted))
        if event["state"] != refused_in:
            return event
        refused = _refused(team, event)
        if take < _TAKES:
            team.teller.tell(f"image refused, another exposure: {refused}")
    raise refused


def _expose(team: Team, wanted: tuple[str, ...]) -> Json:
    after = int(team.operator.status()["sequence"])
    team.operator.command("exposure-requested")
    with team.teller.doing("X-ray"):
        team.door.expose()
        event = await_event(team.surgeon, after, wanted, _RESULT_WITHIN_S)
    return event if event["state"] != HELD else event | {"state": leave_hold(team)}


def _refused(team: Team, event: Json) -> DemoFailed:
    reason = event["data"].get("reason")
    if reason is not None:
        return DemoFailed(str(reason["code"]), f"{reason['message']}, {measured(reason)}")
    return DemoFailed("interlock_refused", why(team.surgeon, event["data"]["told_as"]))
