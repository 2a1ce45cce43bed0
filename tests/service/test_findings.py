"""The picture of what was found in a refused image: in the record with the refusal, and read back over HTTP."""

import asyncio
import base64
from functools import partial
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest

from service.auth.permissions import Role
from service.cases import store
from service.cases.records import NewCase, NewEvent
from service.conductor.image_flow import ImageFlow
from service.conductor.taking import Prepared
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.images.dicom_header import DicomHeader
from service.images.findings import findings_of
from service.images.store import NewPurpose, add_image, assign_purpose, purpose_of
from service.vision_jobs import evaluate, register
from workflow.triggers import Trigger

PICTURE = b"\x89PNG a picture"
REFUSED = {"status": "refused", "reason": {"code": "mirrored", "message": "flipped", "measured": -9.0, "limit": 20.0}}
OPENED = NewEvent("case_opened", None, "case_open", {"state": "case_open"}, {})


def _image(database: Database, content: bytes = b"bytes") -> str:
    with database.write() as connection:
        header = DicomHeader(None, None, None, None, {})
        return add_image(connection, content, header, None, {}).id


def _open_case(database: Database, user_id: str) -> None:
    new = NewCase("case", "room-1", "P1", "1.2.3", user_id, "0" * 64, {}, {})
    with database.write() as connection:
        store.open_case(connection, new, OPENED)


def _record(
    database: Database,
    monkeypatch: pytest.MonkeyPatch,
    image_id: str,
    result: dict[str, Any],
    *,
    verifies: bool = False,
) -> None:
    """Let image work on a case's image end with a result, and record what the flow makes of it."""
    with database.write() as connection:
        if purpose_of(connection, image_id) is None:
            assign_purpose(connection, NewPurpose(image_id, "case", "registration", {}, ()))

    async def work(*_arguments: object) -> dict[str, Any]:
        return result

    def observe(case_id: str, trigger: Trigger, prepare: Any) -> None:
        prepared: Prepared = prepare(None)
        event = NewEvent(trigger, None, "carm_positioned", {}, prepared.data)
        with database.write() as connection:
            store.append(connection, case_id, event, expected_version=None)
            if prepared.also is not None:
                prepared.also(connection, SimpleNamespace())

    async def run() -> None:
        conductor: Any = SimpleNamespace(on_effect={}, observe=observe)
        flow = ImageFlow(conductor)
        if verifies:
            await flow._evaluate(SimpleNamespace(), "case", image_id)
        else:
            await flow._register("case", image_id)

    monkeypatch.setattr("service.conductor.image_flow.register_image", work)
    monkeypatch.setattr("service.conductor.image_flow.evaluate_image", work)
    monkeypatch.setattr(ImageFlow, "_target", lambda _self, _taken: {})
    asyncio.run(run())


def _with_picture(picture: bytes) -> dict[str, Any]:
    return REFUSED | {"findings_png_base64": base64.b64encode(picture).decode()}


def test_the_picture_of_the_newest_refusal_is_read_back(database, users, monkeypatch):
    _open_case(database, users.add("anna", Role.SURGEON, "correct horse", "2468").id)
    image_id, other_id = _image(database), _image(database)
    _record(database, monkeypatch, image_id, _with_picture(b"older"))
    _record(database, monkeypatch, image_id, _with_picture(PICTURE))
    _record(database, monkeypatch, other_id, _with_picture(b"another image's"))
    with database.read() as connection:
        assert findings_of(connection, image_id) == PICTURE
        newest = store.newest_event(connection, "case")
    assert newest.data["reason"] == REFUSED["reason"]
    assert "findings_png_base64" not in newest.data


def test_a_refused_verification_keeps_its_picture_too(database, users, monkeypatch):
    _open_case(database, users.add("anna", Role.SURGEON, "correct horse", "2468").id)
    image_id = _image(database)
    _record(database, monkeypatch, image_id, _with_picture(PICTURE), verifies=True)
    with database.read() as connection:
        assert findings_of(connection, image_id) == PICTURE
        newest = store.newest_event(connection, "case")
    assert (newest.trigger, newest.data["reason"]) == (Trigger.VERIFICATION_REFUSED, REFUSED["reason"])


def test_a_refusal_without_a_picture_is_recorded_and_has_none(database, users, monkeypatch):
    _open_case(database, users.add("anna", Role.SURGEON, "correct horse", "2468").id)
    image_id = _image(database)
    _record(database, monkeypatch, image_id, REFUSED)
    with database.read() as connection:
        assert store.newest_event(connection, "case").data["reason"]["code"] == "mirrored"
        with pytest.raises(ServiceError) as refusal:
            findings_of(connection, image_id)
    assert refusal.value.code == ErrorCode.FINDINGS_UNKNOWN


def test_the_picture_is_a_png_over_http_for_those_who_signed_in(running, monkeypatch):
    database = running.parts.database
    with running.client() as client:
        _open_case(database, client.get("/session").json()["user_id"])
        refused_id, fresh_id = _image(database), _image(database)
        _record(database, monkeypatch, refused_id, _with_picture(PICTURE))
        answer = client.get(f"/images/{refused_id}/findings")
        none = client.get(f"/images/{fresh_id}/findings")
    assert (answer.status_code, answer.headers["content-type"], answer.content) == (200, "image/png", PICTURE)
    assert (none.status_code, none.json()["code"]) == (404, "findings_unknown")
    with running.client(None) as anonymous:
        assert anonymous.get(f"/images/{refused_id}/findings").status_code == 401


def test_image_work_draws_what_it_refuses_and_nothing_of_what_is_no_image(make_xray, device_files):
    devices = (device_files["guide"].encode(), device_files["carm"].encode())
    image = make_xray(rows=256, columns=256)
    before = {"image": image, "handedness_proved": False}
    jobs = (register, partial(evaluate, raw_px=(128.0, 128.0), depth_mm=80.0, before=before))
    for job in jobs:
        refused = job(image, *devices)
        png = np.frombuffer(base64.b64decode(refused["findings_png_base64"]), np.uint8)
        assert refused["status"] == "refused"
        assert cv2.imdecode(png, cv2.IMREAD_COLOR) is not None
        assert "findings_png_base64" not in job(b"no image", *devices)
