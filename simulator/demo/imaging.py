"""The radiographer's part: the C-arm turned and confirmed, exposures requested and made."""

from service.client import Case
from simulator.demo.door_client import Door
from simulator.demo.failure import DemoFailed
from simulator.demo.telling import Teller
from simulator.demo.watching import Json, await_event, why

_RESULT_WITHIN_S = 60.0
_NOT_VERIFIED = "moved"


def turn_carm(operator: Case, door: Door, pedicle: str, teller: Teller) -> None:
    """Into the view in which the planned path projects to a point; what was seen from elsewhere is void."""
    angles = operator.carm_angles(pedicle)
    primary_deg, secondary_deg = angles["primary_angle_deg"], angles["secondary_angle_deg"]
    operator.command("carm-moved", what=f"view for {pedicle}")
    with teller.doing("the C-arm turns"):
        door.position_carm(primary_deg, secondary_deg)
    operator.status()
    operator.command("carm-position-confirmed")
    teller.tell(f"C-arm at {primary_deg:.1f} / {secondary_deg:.1f} deg: {angles['words']}")


def take_registration(operator: Case, door: Door, teller: Teller) -> Json:
    """An exposure, and the guide found in it: the event with what the registration says of itself; DemoFailed."""
    event = _expose(operator, door, ("registration_completed", "registration_refused"), teller)
    data = event["data"]
    if event["state"] != "registered":
        raise _refused(operator, event, "no registration")
    predicted = data["predicted_error_95"]
    teller.tell(
        f"registered: residual {data['residual_rms_px']:.3f} px, {data['balls']} balls, "
        f"predicted within {predicted['angle_deg']:.3f} deg and {predicted['position_mm']:.3f} mm"
    )
    return event


def take_verification(operator: Case, door: Door, teller: Teller) -> Json:
    """An exposure after a motion, and its evaluation: the event with both figures; DemoFailed."""
    event = _expose(operator, door, ("verification_passed", "verification_failed", "verification_refused"), teller)
    if event["state"] == _NOT_VERIFIED:
        raise _refused(operator, event, "no verification")
    return event


def _expose(operator: Case, door: Door, wanted: tuple[str, ...], teller: Teller) -> Json:
    after = int(operator.status()["sequence"])
    operator.command("exposure-requested")
    with teller.doing("X-ray"):
        door.expose()
        return await_event(operator, after, wanted, _RESULT_WITHIN_S)


def _refused(operator: Case, event: Json, text: str) -> DemoFailed:
    reason = event["data"].get("reason")
    if reason is not None:
        measured = f"measured {reason['measured']}, limit {reason['limit']}"
        return DemoFailed(str(reason["code"]), f"{text}: {reason['message']}, {measured}")
    return DemoFailed("interlock_refused", f"{text}: {why(operator, event['trigger'])}")
