"""Opening and reading cases over HTTP."""

import threading
from uuid import uuid4

import pytest

from service.auth.permissions import Role

_TARGETS = [
    {"name": "L4 left", "entry_mm": [30.0, 80.0, 0.0], "target_mm": [10.0, 30.0, 0.0]},
    {"name": "L4 right", "entry_mm": [-30.0, 80.0, 0.0], "target_mm": [-10.0, 30.0, 0.0]},
]
_CASE = {"patient_id": "P1", "study_uid": "1.2.3", "targets": _TARGETS}


def _key() -> dict[str, str]:
    return {"Idempotency-Key": uuid4().hex}


@pytest.fixture(scope="module")
def surgeon(running):
    with running.client() as client:
        yield client


@pytest.fixture(scope="module")
def opened(surgeon, device_files):
    """The room's one open case; before it, the refusals that need a room without devices."""
    without = surgeon.post("/cases", json=_CASE, headers=_key())
    assert (without.status_code, without.json()["code"]) == (404, "device_unknown")
    _upload(surgeon, device_files | {"guide": device_files["guide"] + "\n"}, "expires = 2020-01-01\n")
    expired = surgeon.post("/cases", json=_CASE, headers=_key())
    assert (expired.status_code, expired.json()["code"]) == (409, "device_expired")
    _upload(surgeon, {kind: text.replace("1", "2", 1) for kind, text in device_files.items()}, "")
    headers = _key()
    answers = []
    threads = [
        threading.Thread(target=lambda: answers.append(surgeon.post("/cases", json=_CASE, headers=headers)))
        for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {answer.status_code for answer in answers} == {201}
    assert len({answer.json()["id"] for answer in answers}) == 1
    return answers[0]


def _upload(client, files, first_lines) -> None:
    for kind, text in files.items():
        assert client.post(f"/devices/{kind}", content=first_lines + text).status_code == 201


@pytest.mark.hazard("H14")
def test_eight_equal_posts_open_one_case(surgeon, opened):
    assert [case["id"] for case in surgeon.get("/cases").json()] == [opened.json()["id"]]


def test_a_new_case_tells_state_version_targets_and_device_files(surgeon, opened):
    case = opened.json()
    assert (case["state"], case["version"], opened.headers["etag"]) == ("case_open", 1, '"1"')
    assert case["planned_targets"].keys() == {"L4 left", "L4 right"}
    assert case["devices"].keys() == {"guide", "carm", "tcp", "room"}
    again = surgeon.get(f"/cases/{case['id']}")
    assert again.json() == case
    assert again.headers["etag"] == opened.headers["etag"]


def test_a_second_case_in_the_room_is_refused(surgeon, opened):
    answer = surgeon.post("/cases", json=_CASE, headers=_key())
    assert (answer.status_code, answer.json()["code"]) == (409, "case_open")
    assert opened.json()["id"] in answer.json()["detail"]


def test_the_same_key_for_another_body_is_refused(surgeon, opened):
    headers = {"Idempotency-Key": opened.request.headers["Idempotency-Key"]}
    answer = surgeon.post("/cases", json=_CASE | {"patient_id": "P2"}, headers=headers)
    assert (answer.status_code, answer.json()["code"]) == (422, "idempotency_key_reused")


def test_the_room_status_names_the_open_case(surgeon, opened):
    assert surgeon.get("/status").json()["open_case"] == opened.json()["id"]


def test_the_record_holds_the_whole_state_and_only_auditing_roles_read_it(running, surgeon, opened):
    path = f"/cases/{opened.json()['id']}/audit"
    (event,) = surgeon.get(path).json()
    assert (event["trigger"], event["case_state"]["state"]) == ("case_opened", "case_open")
    with running.client(Role.OPERATOR) as operator:
        assert operator.get(path).json()["code"] == "permission_missing"
