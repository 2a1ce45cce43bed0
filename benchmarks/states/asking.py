"""Requests and statements of people: what is sent, what the model expects, and what it makes of them."""

from dataclasses import dataclass
from typing import Any
from uuid import uuid4

from benchmarks.states.bodies import body_of
from benchmarks.states.people import may
from benchmarks.states.play import Difference, Play, refusing
from benchmarks.states.pressing import press
from benchmarks.states.refusals import Given, Refused, refusal
from benchmarks.states.requests import LEASED
from benchmarks.states.room import PIN

_WITH_PIN = {"move_approved", "insertion_started", "case_closed"}
_SILENT_S = 5.0  # older than any reading that counts
NOTHING: frozenset[str] = frozenset()  # no interlock


@dataclass(frozen=True)
class _Manner:
    """How a request is made; a usual one is as it should be."""

    pin_right: bool = True
    stale: bool = False  # on readings of some seconds ago
    lost: bool = False  # its first answer never comes, and the sender asks again


def ask(play: Play, trigger: str, person: str, *, wild: bool = False) -> str:
    """A request, compared; `wild` lets anything be wrong with it."""
    if trigger == "move_started":
        return _hold(play, person, wild=wild)
    body, given = body_of(play, trigger, wild=wild)
    headers = headers_of(play)
    token, manner = _token(play, headers, wild=wild), _manner(play, trigger, wild=wild)
    if trigger in _WITH_PIN:
        body["pin"] = PIN if manner.pin_right else "9999"
    if manner.stale:
        play.room.clock.now_s += _SILENT_S
    expected = _expected(play, trigger, person, given, token, manner)
    path = play.path(trigger)
    for _ in range(1 + manner.lost):
        answer = play.send("POST", path, person, body, **headers)
    if manner.stale:
        play.room.guard.look()
    play.room.vision.found_again = True
    play.expect(answer, expected)
    if expected is None:
        play.taken.append((person, path, body, headers, answer))
        _take(play, trigger, person, given, answer.body)
    return f"{trigger} by {person} {body}{' stale' * manner.stale}{' lost' * manner.lost}: {expected and expected[0]}"


def state(play: Play, trigger: str, person: str, body: dict[str, Any]) -> str:
    """A fact, compared."""
    headers = {"Idempotency_Key": uuid4().hex} if play.random.random() < 0.5 else {}
    answer = play.send("POST", play.path(trigger), person, body, **headers)
    if not may(person, trigger):
        play.expect(answer, ("permission_missing", NOTHING))
        return f"{trigger} by {person}: permission_missing"
    play.expect(answer, None)
    if headers:
        play.taken.append((person, play.path(trigger), body, headers, answer))
    if trigger == "note":
        play.model.stays("note")
    else:
        play.stopping(lambda: _stated(play, trigger, body))
    return f"{trigger} by {person} {body}"


def headers_of(play: Play) -> dict[str, str]:
    """Of a request as it should be."""
    headers = {"If_Match": f'"{play.version}"', "Idempotency_Key": uuid4().hex}
    return headers if play.lease is None else headers | {"Control_Token": str(play.lease[1])}


def _manner(play: Play, trigger: str, *, wild: bool) -> _Manner:
    draw = play.random.random
    if not wild:
        return _Manner()
    return _Manner(pin_right=trigger not in _WITH_PIN or draw() > 0.15, stale=draw() < 0.05, lost=draw() < 0.1)


def _token(play: Play, headers: dict[str, str], *, wild: bool) -> int | None:
    """The control token that goes with a request: the newest, an older one, or none."""
    if wild and "Control_Token" in headers and play.random.random() < 0.1:
        older = int(headers.pop("Control_Token")) - 1
        headers |= {"Control_Token": str(older)} if play.random.random() < 0.5 else {}
    return int(headers["Control_Token"]) if "Control_Token" in headers else None


def _expected(
    play: Play, trigger: str, person: str, given: Given, token: int | None, manner: _Manner
) -> Refused | None:
    """In the order in which the service looks: who speaks, the PIN, control, the rules."""
    if not may(person, trigger):
        return "permission_missing", NOTHING
    if not manner.pin_right:
        return "pin_refused", NOTHING
    if trigger in LEASED and (play.lease is None or token is None):
        return "lease_missing", NOTHING
    if trigger in LEASED and play.lease != (person, token):
        return "lease_lost", NOTHING
    # The start of an insertion first locks a guard that is not, which then speaks.
    locks = trigger == "insertion_started" and play.model.state == "verified" and not play.room.guard.is_locked
    return refusal(play.model, trigger, play.world(stale=manner.stale and not locks), given)


def _take(play: Play, trigger: str, person: str, given: Given, answer: dict[str, Any]) -> None:
    """What the model makes of a request that was taken."""
    model = play.model
    play.ids |= answer["made"]
    match trigger:
        case "exposure_requested":
            model.exposure_requested(play.now_s)
        case "newest_image_reused":
            model.newest_image_reused()
            play.work.append(("registration", given.image or 0))
        case "plan_requested":
            model.plan_requested(given.kind or "")
        case "move_approved":
            model.move_approved(play.now_s, play.lease[1] if play.lease else 0)
        case "target_confirmed":
            model.target_confirmed(given.planned)
        case "target_done":
            model.target_done(placed=given.placed)
        case "hold_requested":
            model.held(trigger)
        case "acknowledged":
            model.goes(trigger)
        case "case_closed":
            model.ends(trigger, "closed")
        case "lease_taken":
            play.lease = person, int(answer["detail"]["control_token"])
            play.stopping(model.lease_taken)
        case _:
            getattr(model, trigger)()


def _stated(play: Play, trigger: str, body: dict[str, Any]) -> None:
    match trigger:
        case "guide_state_stated" | "sleeve_removed":
            getattr(play.model, trigger)(body["guide"])
        case "case_aborted":
            play.model.ends(trigger, "aborted")
        case "sleeve_in" | "insertion_cancelled":
            getattr(play.model, trigger)()
        case _:
            play.model.seen_to_move(trigger)


def _hold(play: Play, person: str, *, wild: bool) -> str:
    """The held button of a permit."""
    token = _token(play, headers_of(play), wild=wild)
    right = play.model.permit is not None and not (wild and play.random.random() < 0.2)
    given = Given(right=right, token=token or 0)
    expected = _expected(play, "move_started", person, given, token, _Manner())
    problem = press(play, person, play.ids["permit"] if right else "none", token)
    told = None if problem is None else (problem["code"], refusing(problem))
    if (told and told[0]) != (expected and expected[0]):
        raise Difference(f"move_started by {person}, permit right {right}: {told}, expected {expected}")
    if told is not None and told[0] == "interlock" and told != expected:
        raise Difference(f"move_started by {person}, permit right {right}: {told}, expected {expected}")
    if expected is None:
        play.room.drift_known = False
        play.model.move_started()
    return f"move_started by {person}, permit right {right}: {expected and expected[0]}"
