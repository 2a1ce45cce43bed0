"""The radiographer's part: the C-arm turned and confirmed, exposures requested and made."""

from simulator.demo.failure import DemoFailed, measured
from simulator.demo.team import Team
from simulator.demo.watching import Json, await_event, why

_RESULT_WITHIN_S = 60.0
_NOT_VERIFIED = "moved"


def turn_carm(team: Team, pedicle: str) -> None:
    """Into the view in which the planned path projects to a point; what was seen from elsewhere is void."""
    operator = team.operator
    angles = operator.carm_angles(pedicle)
    primary_deg, secondary_deg = angles["primary_angle_deg"], angles["secondary_angle_deg"]
    operator.command("carm-moved", what=f"view for {pedicle}")
    with team.teller.doing("the C-arm turns"):
        team.door.position_carm(primary_deg, secondary_deg, pedicle)
    operator.status()
    operator.command("carm-position-confirmed")
    team.teller.tell(f"C-arm at {primary_deg:.1f} / {secondary_deg:.1f} deg: {angles['words']}")


def take_registration(team: Team) -> Json:
    """An exposure, and the guide found in it: the event with what the registration says of itself; DemoFailed."""
    event = _expose(team, ("registration_completed", "registration_refused"))
    data = event["data"]
    if event["state"] != "registered":
        raise _refused(team, event, "no registration")
    predicted = data["predicted_error_95"]
    team.teller.tell(
        f"registered: residual {data['residual_rms_px']:.3f} px, {data['balls']} balls, "
        f"predicted within {predicted['angle_deg']:.3f} deg and {predicted['position_mm']:.3f} mm"
    )
    return event


def take_verification(team: Team) -> Json:
    """An exposure after a motion, and its evaluation: the event with both figures; DemoFailed."""
    event = _expose(team, ("verification_passed", "verification_failed", "verification_refused"))
    if event["state"] == _NOT_VERIFIED:
        raise _refused(team, event, "no verification")
    return event


def _expose(team: Team, wanted: tuple[str, ...]) -> Json:
    after = int(team.operator.status()["sequence"])
    team.operator.command("exposure-requested")
    with team.teller.doing("X-ray"):
        team.door.expose()
        return await_event(team.surgeon, after, wanted, _RESULT_WITHIN_S)


def _refused(team: Team, event: Json, text: str) -> DemoFailed:
    reason = event["data"].get("reason")
    if reason is not None:
        return DemoFailed(str(reason["code"]), f"{text}: {reason['message']}, {measured(reason)}")
    return DemoFailed("interlock_refused", f"{text}: {why(team.surgeon, event['trigger'])}")
