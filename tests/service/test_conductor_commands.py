"""Commands over HTTP against the whole service, with a real database and no arm."""

import hashlib
import json
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from uuid import uuid4

import httpx
import pytest
import sqlalchemy as sa
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from coaxial_client import Case, Coaxial, Refused
from service.auth.permissions import Role
from service.cases.opening import CaseToOpen, open_case
from service.conductor.routers import CONDUCTOR_ROUTERS
from service.database import tables
from workflow.triggers import Kind, Trigger

_CASE = {
    "patient_id": "P1",
    "study_uid": "1.2.3",
    "targets": [{"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}],
}
# Read and export are GET requests; a move starts with the held button; observations are nobody's command.
_NO_COMMAND = {Trigger.READ, Trigger.EXPORT, Trigger.MOVE_STARTED}


@pytest.fixture(scope="module")
def sign_in(running) -> Callable[[Role], Coaxial]:
    def make(role: Role) -> Coaxial:
        client = Coaxial(running.url)
        client.sign_in(role.value, "correct horse")
        return client

    return make


@pytest.fixture
def case(sign_in, device_files) -> Iterator[Case]:
    with sign_in(Role.SURGEON) as surgeon:
        for kind, content in device_files.items():
            surgeon.upload_device(kind, content.encode())
        case = surgeon.open_case(_CASE)
        yield case
        case.command("case-aborted", reason="end of the test")


def _headers(case: Case, **changes: str | None) -> dict[str, str]:
    headers = {"If-Match": f'"{case.status()["version"]}"', "Idempotency-Key": uuid4().hex} | changes
    return {name: value for name, value in headers.items() if value is not None}


def _refusal(call: Callable[[], object]) -> Refused:
    with pytest.raises(Refused) as caught:
        call()
    return caught.value


def test_every_request_and_fact_of_the_table_has_a_route() -> None:
    paths = {route.path for router in CONDUCTOR_ROUTERS for route in router.routes}
    commands = [trigger for trigger in Trigger if trigger.kind is not Kind.OBSERVATION and trigger not in _NO_COMMAND]
    missing = [one for one in commands if f"/cases/{{case_id}}/{one.replace('_', '-')}" not in paths]
    assert missing == []


@pytest.mark.hazard("H27")
def test_a_stranger_can_neither_command_nor_stop(running, case) -> None:
    for path in (f"/cases/{case.id}/carm-position-confirmed", "/stop", f"/cases/{case.id}/emergency-access"):
        answer = httpx.post(f"{running.url}/api{path}", json={})
        assert (answer.status_code, answer.json()["code"]) == (401, "not_signed_in")


@pytest.mark.parametrize(
    ("missing", "status", "code"),
    [("If-Match", 428, "version_missing"), ("Idempotency-Key", 400, "idempotency_key_missing")],
)
def test_a_request_needs_the_version_it_was_decided_on_and_a_key(case, missing, status, code) -> None:
    headers = _headers(case, **{missing: None})
    refused = _refusal(lambda: case.room.post(f"/cases/{case.id}/hold-requested", {"reason": "pause"}, headers))
    assert (refused.status, refused.code) == (status, code)
    assert case.status()["state"] == "case_open"


def test_a_stale_version_is_refused_remembered_and_changes_nothing(case) -> None:
    stale = _headers(case)
    case.command("guide-state-stated", guide="empty")
    before = case.status()
    refused = _refusal(lambda: case.room.post(f"/cases/{case.id}/hold-requested", {"reason": "pause"}, stale))
    assert (refused.status, refused.code) == (412, "version_stale")
    after = case.status()
    assert (after["state"], after["version"]) == (before["state"], before["version"])
    assert case.attempts()[0]["code"] == "version_stale"


@pytest.mark.hazard("H14")
def test_equal_posts_have_one_effect_and_one_answer(case) -> None:
    headers, path = _headers(case), f"/cases/{case.id}/hold-requested"
    with ThreadPoolExecutor(8) as pool:
        posts = [pool.submit(case.room.post, path, {"reason": "pause"}, headers) for _ in range(16)]
        answers = [post.result() for post in posts]
    assert all(answer == answers[0] for answer in answers)
    assert [event["trigger"] for event in case.record()].count("hold_requested") == 1


def test_a_key_is_good_for_one_request_only(case) -> None:
    headers, path = _headers(case), f"/cases/{case.id}/hold-requested"
    case.room.post(path, {"reason": "pause"}, headers)
    refused = _refusal(lambda: case.room.post(path, {"reason": "another"}, headers))
    assert (refused.status, refused.code) == (422, "idempotency_key_reused")


def test_a_request_in_the_wrong_state_says_what_leads_onwards(case) -> None:
    refused = _refusal(lambda: case.command("retake", reason="blurred"))
    assert refused.status == 409
    assert "carm_position_confirmed" in refused.leads_onwards
    assert case.status()["state"] == "case_open"
    assert case.attempts()[0]["accepted"] is False


def test_an_unknown_case_is_not_found_and_the_attempt_is_remembered(case) -> None:
    stranger = case.room.case("no-such-case")
    stranger.version = 1
    refused = _refusal(lambda: stranger.command("retake", reason="blurred"))
    assert (refused.status, refused.code) == (404, "case_unknown")
    assert case.room.get_list("/interlocks")[0]["code"] == "case_unknown"


@pytest.mark.hazard("H09")
@pytest.mark.parametrize("number", ["NaN", "Infinity", "1e9"])
def test_a_number_that_is_none_or_implausible_is_refused_by_its_field(case, running, number) -> None:
    body = f'{{"image_id": "x", "pixel_px": [{number}, 5], "space": "raw"}}'
    with running.client(Role.SURGEON) as client:
        path, headers = f"/cases/{case.id}/target-echo", {"Content-Type": "application/json"}
        answer = client.post(path, content=body, headers=headers)
    assert (answer.status_code, answer.json()["code"]) == (422, "malformed_request")
    assert "pixel_px" in answer.text


def test_without_an_arm_nothing_that_needs_one_is_allowed_and_the_reason_is_told(case) -> None:
    case.take_lease("start")
    case.command("guide-state-stated", guide="empty")
    refused = _refusal(lambda: case.command("carm-position-confirmed"))
    assert refused.code == "interlock"
    assert {verdict["code"] for verdict in refused.verdicts if not verdict["passed"]} == {"at_rest"}
    goal = {"translation_mm": [300.0, 0.0, 400.0]}
    assert _refusal(lambda: case.plan("approach", base_from_goal=goal)).code == "arm_unknown"
    assert case.status()["allowed"]["carm_position_confirmed"]["reasons"][0]["code"] == "at_rest"


def test_a_plan_takes_the_goal_of_its_kind_and_no_other(case) -> None:
    case.take_lease("start")
    refused = _refusal(lambda: case.plan("retreat", base_from_goal={"translation_mm": [0.0, 0.0, 0.0]}))
    assert (refused.status, refused.code) == (422, "malformed_request")


def test_every_verdict_of_a_refused_request_is_in_the_record(case) -> None:
    refused = _refusal(lambda: case.command("carm-position-confirmed"))
    attempt = case.attempts()[0]
    assert attempt["code"] == "interlock"
    assert [one["code"] for one in attempt["verdicts"]] == [one["code"] for one in refused.verdicts]


@pytest.mark.hazard("H15")
def test_a_plan_needs_the_lease_and_the_newest_one(case, sign_in) -> None:
    goal = {"translation_mm": [300.0, 0.0, 400.0]}
    assert _refusal(lambda: case.plan("approach", base_from_goal=goal)).code == "lease_missing"
    case.take_lease("start")
    with sign_in(Role.SURGEON) as second:
        second.case(case.id).take_lease("taking over")
    case.status()
    assert _refusal(lambda: case.plan("approach", base_from_goal=goal)).code == "lease_lost"


@pytest.mark.hazard("H13")
def test_a_wrong_pin_approves_nothing(case) -> None:
    case.take_lease("start")
    refused = _refusal(lambda: case.command("move-approved", plan_id="p", pin="9999"))
    assert (refused.status, refused.code) == (403, "pin_refused")


def test_an_operator_states_facts_and_may_not_approve(case, sign_in) -> None:
    with sign_in(Role.OPERATOR) as operator:
        theirs = operator.case(case.id)
        assert theirs.command("patient-moved", what="coughed")["state"] == "case_open"
        assert _refusal(lambda: theirs.command("acknowledged", guide="empty")).code == "permission_missing"


def test_a_note_and_a_refused_request_leave_the_version_as_it_is(case) -> None:
    version = case.status()["version"]
    case.command("note", text="table lowered")
    _refusal(lambda: case.command("retake", reason="blurred"))
    assert case.status()["version"] == version


def test_the_stream_goes_on_behind_the_last_event_that_was_seen(case) -> None:
    case.command("note", text="one")
    seen = case.status()["sequence"]
    case.command("note", text="two")
    stream = case.events(after=seen)
    event = next(stream)
    stream.close()
    assert (event["sequence"], event["data"]["text"]) == (seen + 1, "two")


@pytest.mark.hazard("H13")
def test_a_hold_without_a_permit_is_refused_with_every_verdict(case) -> None:
    case.take_lease("start")
    case.command("guide-state-stated", guide="empty")
    with pytest.raises(Refused) as caught, case.hold("no-such-permit"):
        pass
    assert (caught.value.status, caught.value.code) == (409, "missing")
    refused = {verdict["code"] for verdict in caught.value.verdicts if not verdict["passed"]}
    assert {"permit_current", "hold_pressed"} <= refused


def test_what_an_interlock_measured_is_not_told_as_the_measure_of_a_case_that_is_held(case) -> None:
    case.take_lease("start")
    case.command("hold-requested", reason="look")
    held = _refusal(lambda: case.command("insertion-started", pin="2468"))
    assert (held.code, held.measured, held.limit) == ("held", None, None)
    assert any(verdict["limit"] is not None for verdict in held.verdicts if not verdict["passed"])


def test_a_hold_that_names_no_permit_is_refused_as_any_request_is(running, case) -> None:
    url = f"{running.url.replace('http', 'ws', 1)}/api/cases/{case.id}/hold"
    headers = {"Authorization": f"Bearer {running.tokens[Role.SURGEON]}"}
    with pytest.raises(InvalidStatus) as caught, connect(url, additional_headers=headers):
        pass
    problem = json.loads(caught.value.response.body)
    assert (caught.value.response.status_code, problem["code"]) == (422, "malformed_request")
    assert [one["field"] for one in problem["fields"]] == ["query.permit"]


@pytest.mark.hazard("H27")
def test_a_hold_from_another_site_is_refused(running, case) -> None:
    url = f"{running.url.replace('http', 'ws', 1)}/api/cases/{case.id}/hold?permit=p"
    headers = {"Authorization": f"Bearer {running.tokens[Role.SURGEON]}", "Origin": "https://elsewhere.example"}
    with pytest.raises(InvalidStatus) as caught, connect(url, additional_headers=headers):
        pass
    assert caught.value.response.status_code == 403
    assert json.loads(caught.value.response.body)["code"] == "origin_refused"


def test_a_case_with_an_open_target_does_not_close_until_it_is_abandoned_with_a_reason(case) -> None:
    case.command("guide-state-stated", guide="empty")
    assert _refusal(lambda: case.command("case-closed", pin="2468")).code == "targets_open"
    closed = case.command("case-closed", pin="2468", abandoned={"L3 left": "narrow pedicle"})
    assert closed["state"] == "closed"


@pytest.mark.hazard("H27")
def test_what_is_kept_of_an_answered_request_tells_nobody_the_pin_that_was_in_it(running, case) -> None:
    case.command("guide-state-stated", guide="empty")
    path, headers = f"/api/cases/{case.id}/case-closed", _headers(case) | {"Content-Type": "application/json"}
    body = {"pin": "2468", "abandoned": {"L3 left": "narrow pedicle"}}
    with running.client() as surgeon:
        assert surgeon.post(path.removeprefix("/api"), content=json.dumps(body), headers=headers).status_code == 200
    with running.parts.database.read() as connection:
        query = sa.select(tables.idempotency_keys).where(tables.idempotency_keys.c.key == headers["Idempotency-Key"])
        kept = repr(connection.execute(query).one())
    for pin in range(10_000):
        request = ["POST", path, json.dumps(body | {"pin": f"{pin:04}"})]
        assert hashlib.sha256("\0".join(request).encode()).hexdigest() not in kept, f"it was {pin:04}"


def test_device_files_can_be_changed_and_an_unknown_one_is_refused(case) -> None:
    assert _refusal(lambda: case.command("device-changed", devices={"carm": "no-such-file"})).code == "device_unknown"
    assert case.command("device-changed", what="recalibrated")["trigger"] == "device_changed"


@pytest.mark.parametrize("role", list(Role))
def test_everyone_may_stop_and_the_stop_is_in_the_record(case, sign_in, role) -> None:
    with sign_in(role) as presser:
        answer = presser.stop()
    assert answer["recorded"] is True
    assert answer["case_id"] == case.id
    status = case.status()
    assert (status["state"], status["held_for"]) == ("safe_hold", "stop")


def test_a_locked_session_may_stop_and_nothing_else(case, sign_in) -> None:
    with sign_in(Role.OPERATOR) as operator:
        operator.post("/session/lock")
        assert _refusal(lambda: operator.get(f"/cases/{case.id}/status")).code == "session_locked"
        assert operator.stop()["recorded"] is True


@pytest.mark.hazard("H32")
def test_a_stop_does_not_wait_for_the_database_and_is_recorded_when_it_is_free(running, case) -> None:
    locked, free = threading.Event(), threading.Event()

    def hog() -> None:
        with running.parts.database.write():
            locked.set()
            free.wait(10)

    hogging = threading.Thread(target=hog)
    hogging.start()
    locked.wait(5)
    try:
        answer = case.stop()
    finally:
        free.set()
        hogging.join()
    assert answer["recorded"] is False
    case.wait_for("safe_hold", timeout_s=10)


def _over_case(_: object, case: Case) -> str:
    case.command("case-aborted", reason="another one follows")
    return case.id


def _case_of_another_room(running: object, case: Case) -> str:
    elsewhere = running.parts.settings.model_copy(update={"room": "elsewhere"})
    session = running.parts.sessions.remembered(running.tokens[Role.SURGEON])
    _over_case(running, case)
    with running.parts.database.write() as connection:
        return open_case(connection, CaseToOpen(**_CASE), session, elsewhere).case_id


@pytest.mark.hazard("H18")
@pytest.mark.parametrize("other", [_over_case, _case_of_another_room])
def test_a_stop_under_another_cases_name_holds_the_case_that_the_room_is_in(running, sign_in, case, other) -> None:
    """The arm that stopped is this room's; a stop whose record never ended would keep its guard locked for good."""
    name = other(running, case)
    with sign_in(Role.SURGEON) as surgeon:
        newer = surgeon.open_case(_CASE)
        answer = surgeon.post(f"/cases/{name}/stop", {}, {})
        assert (answer["recorded"], answer["case_id"]) == (True, newer.id)
        assert newer.status()["state"] == "safe_hold"
        newer.command("case-aborted", reason="end of the test")
