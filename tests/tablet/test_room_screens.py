"""The screens outside a procedure: a new case, the record of a past one, what the engineer looks after."""

import json
import re
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from io import BytesIO
from uuid import uuid4

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from PIL import Image
from playwright.sync_api import Page, Route
from pydicom import dcmread
from pydicom.uid import generate_uid

from service.auth.permissions import Role
from tests.service.conftest import PIN
from tests.tablet.picture import take_picture
from tests.tablet.tablet import Tablet
from workflow.states import State

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
_SCHEDULED = {
    "patient_id": "P2",
    "patient_name": "Doe^Jane",
    "birth_date": "1961-05-04",
    "sex": "F",
    "study_uid": "1.2.4",
    "accession_number": "A1",
    "description": "Pedicle screws",
    "scheduled_at": "2026-11-22T08:00:00",
    "station": "OR1",
}
_AGES = "hours => import('/js/words.js').then(({ age }) => hours.map(age))"
_BY_HAND = {
    "Patient id": "P3",
    "Study UID": "1.2.5",
    "Name": "L4-right",
    **{"Entry x": "-30.5", "Entry y": "85", "Entry z": "12,25"},
    **{"Target x": "-20", "Target y": "40.125", "Target z": "4"},
}


@pytest.mark.lengthy
def test_a_case_is_entered_by_hand_and_opened(room):
    tablet = room.tablet_of(Role.SURGEON)
    tablet.hand.tap("New case")
    for name, typed in _BY_HAND.items():
        tablet.hand.tap(tablet.page.get_by_label(name, exact=True))
        tablet.page.keyboard.type(typed)
    tablet.hand.tap("Open the case")
    tablet.is_at("case_open")
    tablet.page.locator(".target-card", has_text="L4-right").wait_for()
    opened = room.abort_case()
    planned = opened["planned_targets"]["L4-right"]
    assert (opened["patient_id"], opened["study_uid"]) == ("P3", "1.2.5")
    assert (planned["entry_mm"], planned["target_mm"]) == ([-30.5, 85.0, 12.25], [-20.0, 40.125, 4.0])
    assert planned["position"] == "prone"


def test_a_plan_from_3d_slicer_and_the_worklist_open_a_case(room):
    tablet = room.tablet_of(Role.SURGEON)
    page, hand = tablet.page, tablet.hand
    hand.tap("New case")
    hand.tap("Open the case")
    page.get_by_text("Some fields cannot be taken").wait_for()
    assert page.locator("input[aria-invalid=true]").count() == 9
    _choose(tablet, "spine.mrk.json", json.dumps(_MARKUPS))
    page.get_by_text("spine.mrk.json: 1 planned paths").wait_for()
    page.route("**/api/worklist", lambda route: route.fulfill(json=[_SCHEDULED]))  # a hospital's, asked for by DICOM
    hand.tap("From the worklist")
    hand.tap("Doe Jane")
    take_picture(page, "new_case")
    hand.tap("Supine")
    hand.tap("Open the case")
    tablet.is_at("case_open")
    opened = room.abort_case()
    planned = opened["planned_targets"]["L3-left"]
    assert (opened["patient_id"], opened["study_uid"]) == ("P2", "1.2.4")
    assert planned["entry_mm"] == [-32.25, -85.1, 12.0]
    assert planned["target_mm"] == [-20.0, -40.0, 4.0]
    assert planned["position"] == "supine"


def test_a_quarantined_image_is_seen_with_the_reason_and_called_a_scout(room, open_case):
    with room.running.client() as client:
        earlier = client.get(f"/images?case={room.case_id}").json()[0]["id"]
        stranger = _of_another_patient(client.get(f"/images/{earlier}/original").content)
        client.post("/images", content=stranger, headers={"Content-Type": "application/dicom"})
    tablet = room.tablet_of(Role.SURGEON)
    tablet.press("Enter the case")
    tablet.is_at("case_open")
    tablet.hand.tap("More", exact=True)
    tablet.hand.tap("Images of the case")
    tablet.page.locator(".entry-line", has_text="Quarantined").wait_for()
    assert "P9" in tablet.page.locator(".entry-line").inner_text()
    assert "another patient's image" in tablet.page.locator(".detail").inner_text()
    tablet.page.locator(".review-seen canvas").wait_for()
    tablet.hand.tap("It is a scout")
    tablet.hand.tap("The C-arm still had another name")
    tablet.page.locator(".entry-line", has_text="Scout").wait_for()
    assert tablet.page.get_by_role("button", name="Emergency access").is_visible()
    tablet.hand.tap("Lock")
    tablet.page.get_by_role("heading", name="Locked").wait_for()
    assert tablet.page.get_by_role("button", name="Emergency access").is_visible()
    tablet.hand.enter(PIN)
    tablet.hand.tap("Back")
    tablet.is_at("case_open")


def test_an_image_that_names_nobody_waits_until_somebody_says_whose_it_is(room, open_case):
    picture = BytesIO()
    Image.fromarray(np.random.default_rng(3).integers(0, 65536, (300, 280), dtype=np.uint16)).save(picture, "PNG")
    with room.running.client() as client:
        client.post("/images", content=picture.getvalue(), headers={"Content-Type": "image/png"}).raise_for_status()
    tablet = room.tablet_of(Role.OPERATOR)
    tablet.page.evaluate(f"location.hash = 'images/{open_case}'")
    tablet.page.locator(".entry-line", has_text="Nobody has decided").wait_for()
    tablet.hand.tap("Of P1: another exposure")
    tablet.page.locator(".entry-line", has_text="Not used").wait_for()


def test_the_engineer_makes_the_daily_check_and_is_told_what_failed(room):
    tablet = room.tablet_of(Role.ENGINEER)
    tablet.hand.tap("Daily check")
    tablet.press("Begin the check")
    failed = tablet.page.locator(".checked-item.is-bad")
    failed.wait_for()
    assert "Switch the arm on" in failed.inner_text()
    take_picture(tablet.page, "daily_check")
    tablet.hand.tap("Cases")
    tablet.page.get_by_role("button", name=re.compile(r"Failed, (just now|\d+ min ago)")).wait_for()
    assert tablet.page.evaluate(_AGES, [0.01, 0.5, 30.9]) == ["just now", "30 min ago", "30 h ago"]
    take_picture(tablet.page, "cases")
    assert _faults_by_axe(tablet) == []


def test_device_files_are_read_uploaded_and_seen_to_expire(room):
    tablet = room.tablet_of(Role.ENGINEER)
    page, hand = tablet.page, tablet.hand
    hand.tap("Device files")
    hand.tap("Read the file")
    text = page.locator(".file-text", has_text="reference-guide")
    newer = f"expires = {_soon()}\n{text.inner_text()}".replace("version = 1", "version = 7")
    hand.tap("Close")
    _choose(tablet, "newer.toml", newer)
    page.locator(".device.is-soon").wait_for()
    _choose(tablet, "broken.toml", newer.replace("radius = 20.0", "radius = 0.02"))
    assert "radius" in page.locator(".told").inner_text()
    assert f"good until {_soon()}, 10 days" in page.locator(".device.is-soon").inner_text()
    assert _faults_by_axe(tablet) == []
    page.route("**/api/**", _answer_in_twenty_days)
    page.reload()
    assert f"expired on {_soon()}" in page.locator(".device.is-over").inner_text()


def test_the_door_speaks_every_language(room):
    tablet = room.open_at(room.running.url)
    tablet.page.goto(tablet.url)
    tablet.page.locator(".pad").wait_for()
    take_picture(tablet.page, "sign_in")
    for code, words in (("de", "Passwort verwenden"), ("en", "Use the password")):
        tablet.hand.tap(tablet.page.locator(f".language[lang={code}]"))
        tablet.page.get_by_role("button", name=words).wait_for()
        assert tablet.page.locator("html").get_attribute("lang") == code


def test_the_auditor_goes_through_the_record_of_a_case(room):
    room.put(State.CLOSED)  # by nobody
    with room.running.client() as client:
        refused = client.post(
            f"/cases/{room.case_id}/carm-position-confirmed",
            json={},
            headers={"Idempotency-Key": uuid4().hex, "If-Match": '"0"', "Control-Token": "0"},
        ).json()
    tablet = room.tablet_of(Role.AUDITOR)
    page, hand = tablet.page, tablet.hand
    page.evaluate(f"location.hash = 'review/{room.case_id}'")
    _entry(tablet, "Verification passed")
    assert page.locator(".compare canvas").count() == 2
    assert "within" in page.locator(".detail").inner_text()
    take_picture(page, "record")
    _entry(tablet, "Registration completed")
    page.get_by_role("group", name="Drawn over the image").wait_for()
    hand.tap("Refusals")
    assert page.locator(".entry-line").count() == 1
    hand.tap("Refusals")
    _only_the_entries_of("surgeon", page)
    assert refused["code"] == "case_over"
    assert _faults_by_axe(tablet) == []
    with page.expect_download() as report:
        hand.tap(page.get_by_role("link", name="Report (PDF)"))
    assert report.value.path().read_bytes().startswith(b"%PDF")


def _only_the_entries_of(person: str, page: Page) -> None:
    """Chosen by name, and everybody's again."""
    lines, of_person = page.locator(".entry-line"), page.locator(".entry-line", has_text=person)
    everybody, theirs = lines.count(), of_person.count()
    assert 0 < theirs < everybody
    page.get_by_label("Whose entries").select_option(label=person)
    lines.nth(theirs).wait_for(state="detached")
    assert lines.count() == of_person.count() == theirs
    page.get_by_label("Whose entries").select_option(label="Everybody")
    lines.nth(everybody - 1).wait_for()


def _entry(tablet: Tablet, words: str) -> None:
    tablet.hand.tap(tablet.page.locator(".entry-line button", has_text=words))
    tablet.page.locator(".detail-head h2", has_text=words).wait_for()
    tablet.page.locator(".review-seen canvas").first.wait_for()


def _of_another_patient(content: bytes) -> bytes:
    image, file = dcmread(BytesIO(content)), BytesIO()
    image.PatientID, image.SOPInstanceUID = "P9", generate_uid()
    image.file_meta.MediaStorageSOPInstanceUID = image.SOPInstanceUID
    # the same pixels, or the same time, would have come before
    image.PixelData, image.AcquisitionDate = image.pixel_array[::-1].tobytes(), "20991231"
    image.save_as(file)
    return file.getvalue()


def _choose(tablet: Tablet, name: str, text: str) -> None:
    file = {"name": name, "mimeType": "text/plain", "buffer": text.encode()}
    tablet.page.locator("input[type=file]").set_input_files([file])


def _answer_in_twenty_days(route: Route) -> None:
    """By the service's clock, which is the one that counts."""
    answer, then = route.fetch(), datetime.now(UTC) + timedelta(days=20)
    route.fulfill(response=answer, headers=answer.headers | {"date": format_datetime(then, usegmt=True)})


def _soon() -> str:
    """Ten days from now."""
    return (datetime.now(UTC).date() + timedelta(days=10)).isoformat()


def _faults_by_axe(tablet: Tablet) -> list[str]:
    return [one["id"] for one in Axe().run(tablet.page).response["violations"]]
