"""The screens outside a procedure: a new case, the record of a past one, what the engineer looks after."""

import json
from collections.abc import Iterator
from typing import Any
from uuid import uuid4

import pytest

from service.auth.permissions import Role
from tests.tablet.quiet_room import QuietRoom

_PATH = {"entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}
_MARKUPS = {
    "markups": [
        {
            "type": "Line",
            "name": "L3-left",
            "coordinateSystem": "RAS",
            "controlPoints": [{"position": [32.25, 85.1, 12.0]}, {"position": [20.0, 40.0, 4.0]}],
        }
    ]
}


@pytest.fixture
def open_case(room: QuietRoom) -> Iterator[str]:
    """A case of patient P1, aborted after the test."""
    body = {"patient_id": "P1", "study_uid": "1.2.3", "targets": [_PATH | {"name": "L3-left"}]}
    with room.running.client() as client:
        yield client.post("/cases", json=body, headers={"Idempotency-Key": uuid4().hex}).json()["id"]
    _abort(room)


def test_a_plan_from_3d_slicer_opens_a_case(room):
    tablet = room.tablet_of(Role.SURGEON)
    page, hand = tablet.page, tablet.hand
    hand.tap("New case")
    hand.tap("Open the case")
    page.get_by_text("Some fields cannot be taken").wait_for()
    assert page.locator("input[aria-invalid=true]").count() == 9
    plan = {"name": "spine.mrk.json", "mimeType": "application/json", "buffer": json.dumps(_MARKUPS).encode()}
    page.locator("input[type=file]").set_input_files([plan])
    page.get_by_text("spine.mrk.json: 1 planned paths").wait_for()
    page.get_by_label("Patient id").fill("P2")
    page.get_by_label("Study UID").fill("1.2.4")
    hand.tap("Supine")
    hand.tap("Open the case")
    tablet.is_at("case_open")
    planned = _abort(room)["planned_targets"]["L3-left"]
    assert planned["entry_mm"] == [-32.25, -85.1, 12.0]
    assert planned["target_mm"] == [-20.0, -40.0, 4.0]
    assert planned["position"] == "supine"


def test_a_quarantined_image_is_seen_with_the_reason(room, open_case):
    with room.running.client() as client:
        earlier = client.get(f"/images?case={room.case_id}").json()[0]["id"]
        content = client.get(f"/images/{earlier}/original").content
        client.post("/images", content=content, headers={"Content-Type": "application/dicom"})
    tablet = room.tablet_of(Role.SURGEON)
    tablet.press("Enter the case")
    tablet.is_at("case_open")
    tablet.hand.tap("More", exact=True)
    tablet.hand.tap("Images of the case")
    tablet.page.locator(".entry-line", has_text="Quarantined").wait_for()
    assert "these pixels came before" in tablet.page.locator(".detail").inner_text()
    tablet.page.locator(".review-seen canvas").wait_for()
    tablet.hand.tap("Back")
    tablet.is_at("case_open")


def _abort(room: QuietRoom) -> dict[str, Any]:
    """End the open case; what it was."""
    with room.running.client() as client:
        case = client.get(f"/cases/{client.get('/status').json()['open_case']}").json()
        client.post(
            f"/cases/{case['id']}/case-aborted", json={"reason": "test"}, headers={"Idempotency-Key": uuid4().hex}
        )
        assert client.get("/status").json()["open_case"] is None
    return case
