"""What people do next: what leads on, or anything at all."""

from collections.abc import Callable
from typing import Any

from benchmarks.states.asking import NOTHING, ask, headers_of, state
from benchmarks.states.happenings import arrive, end_motion, finish_work
from benchmarks.states.model import AIMED
from benchmarks.states.people import PEOPLE
from benchmarks.states.play import Difference, Play, is_over
from benchmarks.states.refusals import Given, Refused, refusal
from benchmarks.states.requests import LISTED

_REQUESTS = [name for name in LISTED if name not in ("stop", "note", "label", "read", "export")]
_GUIDES = ("empty", "wire", "instrument", "unknown")
_BODIES: dict[str, Callable[[Play], dict[str, Any]]] = {
    "guide_state_stated": lambda play: {"guide": play.random.choice(_GUIDES)},
    "sleeve_in": lambda _: {},
    "insertion_cancelled": lambda _: {},
    "sleeve_removed": lambda play: {"guide": play.random.choice(_GUIDES[:2])},
    "carm_moved": lambda _: {"what": "something"},
    "patient_moved": lambda _: {"what": "something"},
    "hand_guided": lambda _: {"what": "something"},
    "device_changed": lambda play: {"devices": play.random.choice(({}, *map(_guide_file, play.devices)))},
    "case_aborted": lambda _: {"reason": "enough"},
    "note": lambda _: {"text": "a remark"},
}
# The usual request in a state.
_USUAL = {
    "case_open": "carm_position_confirmed",
    "registered": "target_confirmed",
    "verified": "insertion_started",
    "off_target": "correction_requested",
    "sleeve_inserted": "target_done",
    "safe_hold": "acknowledged",
}


def _guide_file(devices: dict[str, str]) -> dict[str, str]:
    return {"guide": devices["guide"]}


def go_on(play: Play) -> str:
    """What brings the procedure on."""
    model = play.model
    if play.lease is None and not is_over(play):
        return ask(play, "lease_taken", play.holder)
    if model.guide == "unknown" and model.sleeve is None:
        return state(play, "guide_state_stated", "operator", {"guide": "empty"})
    match model.state:
        case "carm_positioned" | "moved":
            return _see(play)
        case "image_acquired" if play.work:
            return finish_work(play)
        case "target_chosen":
            return _move(play)
        case "moving":
            return end_motion(play)
        case "inserting":
            return state(play, "sleeve_in", play.holder, {})
        case "sleeve_inserted" if model.guide == "instrument":
            return state(play, "sleeve_removed", play.holder, {"guide": "empty"})
        case usual if usual in _USUAL:
            return ask(play, _USUAL[usual], play.holder)
    return state(play, "note", play.holder, {"text": "nothing to do"})


def _see(play: Play) -> str:
    """The next step towards an image of the view, or towards its outcome."""
    if play.model.evaluated is not None and play.work:
        return finish_work(play)
    if play.model.window is None:
        return ask(play, "exposure_requested", "operator")
    return arrive(play, "right")


def _move(play: Play) -> str:
    """The next step towards the motion onto the target."""
    plan = play.model.plan
    if plan is None or plan.used or plan.kind not in AIMED:
        return ask(play, "plan_requested", play.holder)
    return ask(play, "move_approved" if play.model.permit is None else "move_started", play.holder)


def request_anything(play: Play) -> str:
    """Any request by anybody, with whatever comes with it."""
    person = play.holder if play.random.random() < 0.7 else play.random.choice(PEOPLE)
    return ask(play, play.random.choice(_REQUESTS), person, wild=True)


def state_anything(play: Play) -> str:
    """Any fact by anybody; seldom the end of the case."""
    trigger = play.random.choice(list(_BODIES))
    if trigger == "case_aborted" and play.random.random() < 0.8:
        trigger = "note"
    return state(play, trigger, play.random.choice(PEOPLE), _BODIES[trigger](play))


def repeat(play: Play) -> str:
    """An earlier request once more under its key, or another under the same."""
    if not play.taken or play.model.state == "moving":
        return "nothing repeated"
    person, path, body, headers, before = play.random.choice(play.taken)
    if "reason" in body and play.random.random() < 0.3:
        answer = play.send("POST", path, person, body | {"reason": "another"}, **headers)
        play.expect(answer, ("idempotency_key_reused", NOTHING))
        return f"another {path} under the key of an earlier one"
    answer = play.send("POST", path, person, body, **headers)
    if answer != before:
        raise Difference(f"{path} repeated: {answer}, at first {before}")
    return f"{path} repeated"


def be_careless(play: Play) -> str:
    """A request without its version or its key, on another version, or of another form."""
    wrong = play.random.choice(["version_missing", "idempotency_key_missing", "version_stale", "malformed_request"])
    headers, body = headers_of(play), {"reason": "because"}
    expected: Refused | None = (wrong, NOTHING)
    match wrong:
        case "version_missing":
            del headers["If_Match"]
        case "idempotency_key_missing":
            del headers["Idempotency_Key"]
        case "malformed_request":
            body = {"reasons": "because"}
        case _:  # seen only where the rules would have taken it
            headers["If_Match"] = f'"{play.version + 1}"'
            expected = refusal(play.model, "hold_requested", play.world(), Given()) or expected
    play.expect(play.send("POST", play.path("hold_requested"), "surgeon", body, **headers), expected)
    return f"hold_requested: {wrong}"
