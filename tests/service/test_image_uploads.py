"""Images over HTTP: what names a patient goes the C-arm's way, what does not waits for a person's word."""

import io
import json
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from http.client import HTTPConnection
from urllib.parse import urlsplit

import httpx
import numpy as np
import pytest
from PIL import Image

from coaxial_client import Case, Coaxial, Refused
from service.auth.permissions import Role

_CASE = {
    "patient_id": "P1",
    "study_uid": "1.2.3",
    "targets": [{"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}],
}


def _grey(seed: int, bits: int = 16) -> np.ndarray:
    kind = np.uint16 if bits == 16 else np.uint8
    return np.random.default_rng(seed).integers(0, 2**bits, (256, 300), kind)


def _picture(pixels: np.ndarray, form: str = "PNG") -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, form)
    return file.getvalue()


@pytest.fixture
def surgeon(running) -> Iterator[Coaxial]:
    with Coaxial(running.url) as client:
        client.sign_in(Role.SURGEON.value, "correct horse")
        yield client


@pytest.fixture
def case(surgeon, device_files) -> Iterator[Case]:
    for kind, content in device_files.items():
        surgeon.upload_device(kind, content.encode())
    opened = surgeon.open_case(_CASE)
    yield opened
    opened.command("case-aborted", reason="end of the test")


@pytest.fixture
def refusal(surgeon) -> Callable[..., str]:
    def code(media_type: str, content: bytes) -> str:
        before = len(surgeon.get_list("/images"))
        with pytest.raises(Refused) as refused:
            surgeon.upload_image(media_type, content)
        assert 400 <= refused.value.status < 500
        assert len(surgeon.get_list("/images")) == before
        return refused.value.code

    return code


def _arrival(case: Case, image_id: str) -> dict:
    for _ in range(200):
        found = [event for event in case.record() if event["data"].get("image_id") == image_id]
        if found:
            return found[0]
        time.sleep(0.02)
    pytest.fail("the image did not arrive in the case")


def _failed(case: Case) -> set[str]:
    attempt = next(one for one in case.attempts() if one["trigger"] == "image_arrived")
    return {verdict["code"] for verdict in attempt["verdicts"] if not verdict["passed"]}


_PROVENANCE = {"patient_matches", "study_matches", "image_unseen", "pixels_unseen", "image_newer"}


@pytest.mark.parametrize(("form", "bits"), [("PNG", 16), ("PNG", 8), ("TIFF", 16), ("TIFF", 8)])
def test_a_picture_waits_for_a_statement_and_then_arrives_as_any_image(surgeon, case, form, bits) -> None:
    pixels = _grey(len(form) * bits, bits)
    uploaded = surgeon.upload_image(f"image/{form.lower()}", _picture(pixels, form))
    assert uploaded["awaits_statement"]
    assert surgeon.image(uploaded["id"])["purpose"] is None
    answer = case.command("image-identity-stated", image_id=uploaded["id"], patient_id="P1")
    assert (answer["trigger"], answer["state"]) == ("image_arrived", "case_open")
    assert not _PROVENANCE & _failed(case)
    image = surgeon.image(uploaded["id"])
    assert (image["purpose"], image["case_id"]) == ("unassigned", case.id)
    assert surgeon.original(uploaded["id"]) == _picture(pixels, form)
    event = _arrival(case, uploaded["id"])
    assert event["data"]["identity_by_statement"]["patient_id"] == "P1"
    assert event["user_id"] == event["data"]["identity_by_statement"]["user_id"]


@pytest.mark.hazard("H01")
def test_a_statement_about_another_patient_quarantines_the_image(surgeon, case) -> None:
    uploaded = surgeon.upload_image("image/png", _picture(_grey(51)))
    case.command("image-identity-stated", image_id=uploaded["id"], patient_id="P2")
    assert {"patient_matches", "study_matches"} <= _failed(case)
    assert surgeon.image(uploaded["id"])["purpose"] == "quarantined"


@pytest.mark.hazard("H02")
def test_pixels_that_came_before_are_quarantined_whatever_file_they_come_in(surgeon, case, make_xray) -> None:
    pixels = _grey(52)
    surgeon.upload_image("application/dicom", make_xray(rows=256, columns=300, PixelData=pixels.tobytes()))
    for form in ("PNG", "TIFF"):
        again = surgeon.upload_image(f"image/{form.lower()}", _picture(pixels, form))
        assert again["duplicate_of"] is not None
        case.command("image-identity-stated", image_id=again["id"], patient_id="P1")
        assert {"image_unseen", "pixels_unseen"} <= _failed(case)
        assert surgeon.image(again["id"])["purpose"] == "quarantined"


def test_an_upload_that_is_repeated_while_it_waits_is_the_same_image(surgeon, case) -> None:
    content = _picture(_grey(53))
    first, again = (surgeon.upload_image("image/png", content) for _ in range(2))
    assert first["id"] == again["id"]
    case.command("image-identity-stated", image_id=first["id"], patient_id="P1")
    assert not _PROVENANCE & _failed(case)
    assert surgeon.upload_image("image/png", content)["id"] != first["id"]


def test_a_view_or_an_exposure_that_is_not_the_present_one_is_refused(surgeon, case) -> None:
    uploaded = surgeon.upload_image("image/png", _picture(_grey(54)))
    for other in ({"view_id": "v"}, {"window_id": "w"}):
        with pytest.raises(Refused) as refused:
            case.command("image-identity-stated", image_id=uploaded["id"], patient_id="P1", **other)
        assert (refused.value.status, refused.value.code) == (409, "statement_outdated")
    assert surgeon.image(uploaded["id"])["purpose"] is None


def test_an_image_is_stated_once_and_one_that_names_itself_never(surgeon, case, make_xray) -> None:
    named = surgeon.upload_image("application/dicom", make_xray(rows=256, columns=300, seed=55))
    assert not named["awaits_statement"]
    assert _arrival(case, named["id"])["user_id"] is None
    unnamed = surgeon.upload_image("image/png", _picture(_grey(56)))
    case.command("image-identity-stated", image_id=unnamed["id"], patient_id="P1")
    for image_id, code in ((named["id"], "image_named"), (unnamed["id"], "image_taken_in"), ("none", "image_unknown")):
        with pytest.raises(Refused) as refused:
            case.command("image-identity-stated", image_id=image_id, patient_id="P1")
        assert refused.value.code == code


@pytest.mark.parametrize("missing", ["SOPInstanceUID", "PatientID", "StudyInstanceUID"])
def test_dicom_that_does_not_name_everything_waits_and_what_it_names_must_be_right(
    surgeon, case, make_xray, missing
) -> None:
    elements = {name: None if name == missing else "1.9.9" for name in ("PatientID", "StudyInstanceUID")}
    foreign = make_xray(rows=256, columns=300, seed=len(missing), **{**elements})
    if missing == "SOPInstanceUID":
        foreign = _without_instance(foreign)
    uploaded = surgeon.upload_image("application/dicom", foreign)
    assert uploaded["awaits_statement"]
    case.command("image-identity-stated", image_id=uploaded["id"], patient_id="P1")
    assert surgeon.image(uploaded["id"])["purpose"] == "quarantined"


def _without_instance(content: bytes) -> bytes:
    from pydicom import dcmread

    dataset = dcmread(io.BytesIO(content))
    del dataset.SOPInstanceUID
    file = io.BytesIO()
    dataset.save_as(file)
    return file.getvalue()


def test_what_is_no_image_is_refused_and_not_kept(refusal, make_xray) -> None:
    assert refusal("text/plain", b"x") == "media_type_unknown"
    assert refusal("image/png", b"x" * 100) == "unreadable_image"
    assert refusal("image/tiff", b"II*\x00" + b"\xff" * 64) == "unreadable_image"
    assert refusal("image/png", _picture(_grey(1))[:2000]) == "unreadable_image"
    assert refusal("image/png", _picture(np.zeros((300, 300, 3), np.uint8))) == "unsupported_image"
    assert refusal("image/png", _picture(np.zeros((100, 100), np.uint8))) == "unsupported_image"
    assert refusal("image/png", _picture(np.zeros((256, 5000), np.uint8))) == "image_too_large"
    assert refusal("application/dicom", b"no DICOM") == "not_an_image"
    assert refusal("application/dicom", make_xray()[:-500]) == "image_truncated"


def test_a_body_beyond_the_limit_of_images_is_refused_unread(running) -> None:
    limit = running.parts.settings.dicom.max_image_bytes
    address = urlsplit(running.url)
    with closing(HTTPConnection(address.hostname, address.port, timeout=10)) as declared:
        declared.putrequest("POST", "/api/images")
        declared.putheader("Content-Type", "image/png")
        declared.putheader("Content-Length", str(limit + 1))
        declared.endheaders()
        answer = declared.getresponse()
        assert (answer.status, json.load(answer)["limit"]) == (413, limit)
    with running.client(Role.OPERATOR) as operator:
        larger = operator.post("/images", content=b"x" * 5_000_000, headers={"Content-Type": "image/png"})
        assert larger.json()["code"] == "unreadable_image"  # others end at 4 MB
        other = operator.post("/cases", content=b"x" * 5_000_000)
        assert other.status_code == 413


def test_nobody_but_those_who_expose_uploads(running) -> None:
    for role, status in ((Role.AUDITOR, 403), (Role.ENGINEER, 403), (Role.OPERATOR, 422)):
        with running.client(role) as client:
            answer: httpx.Response = client.post("/images", content=b"", headers={"Content-Type": "image/png"})
        assert answer.status_code == status


def _form(content: bytes, media_type: str, field: str = "image") -> dict:
    return {"files": {field: ("a file", content, media_type)}}


def test_a_file_in_a_form_is_the_image_that_it_would_be_as_a_body(running, surgeon, make_xray) -> None:
    picture, named = _picture(_grey(71)), make_xray(rows=256, columns=300, seed=71)
    with running.client(Role.OPERATOR) as operator:
        for media_type, content in (("image/png", picture), ("application/dicom", named)):
            answer = operator.post("/images", **_form(content, media_type))
            assert answer.status_code == 201
            assert surgeon.original(answer.json()["id"]) == content
            assert surgeon.upload_image(media_type, content)["id"] == answer.json()["id"]


def _no_form(content_type: str) -> dict:
    return {"content": b"no form", "headers": {"Content-Type": content_type}}


def test_a_form_of_anything_else_is_refused_and_not_kept(running, surgeon) -> None:
    picture, before = _picture(_grey(72)), len(surgeon.get_list("/images"))
    two = [("image", ("a", picture, "image/png")), ("image", ("b", picture, "image/png"))]
    forms = (
        ({"files": two}, 400, "request_refused"),
        (_form(picture, "image/png") | {"data": {"patient_id": "P1"}}, 400, "request_refused"),
        (_form(picture, "image/png", "file"), 422, "malformed_request"),
        (_form(picture, "application/octet-stream"), 415, "media_type_unknown"),
        (_form(b"no image", "image/png"), 422, "unreadable_image"),
        (_form(b"", "application/dicom"), 422, "not_an_image"),
        (_no_form("multipart/form-data; boundary=x"), 400, "request_refused"),
        (_no_form("multipart/form-data"), 400, "request_refused"),
    )
    with running.client(Role.OPERATOR) as operator:
        for form, status, code in forms:
            answer = operator.post("/images", **form)
            assert (answer.status_code, answer.json()["code"]) == (status, code), form
    assert len(surgeon.get_list("/images")) == before


def test_a_form_that_does_not_say_how_long_it_is_is_refused_where_it_passes_the_limit(running) -> None:
    limit = running.parts.settings.dicom.max_image_bytes
    head = b'--x\r\nContent-Disposition: form-data; name="image"; filename="a"\r\nContent-Type: image/png\r\n\r\n'

    def pieces() -> Iterator[bytes]:
        yield head
        for _ in range(limit // 4_000_000 + 1):
            yield bytes(4_000_000)

    with running.client(Role.OPERATOR) as operator:
        form = {"content": pieces(), "headers": {"Content-Type": "multipart/form-data; boundary=x"}}
        answer = operator.post("/images", **form)
    assert (answer.status_code, answer.json()["code"]) == (413, "body_too_large")
    assert limit < answer.json()["measured"] <= limit + 4_000_000


_CLOSING = {"pin": "2468", "abandoned": {"L3 left": "narrow pedicle"}}


@pytest.mark.parametrize(("end", "said"), [("case-aborted", {"reason": "over"}), ("case-closed", _CLOSING)])
def test_late_images_attach_to_the_case_that_is_over(surgeon, device_files, make_xray, end, said) -> None:
    for kind, content in device_files.items():
        surgeon.upload_device(kind, content.encode())
    study, seed = f"1.2.{len(end)}{len(said)}", 60 + 10 * len(said)
    case = surgeon.open_case(_CASE | {"study_uid": study})
    case.command("guide-state-stated", guide="empty")
    state = case.command(end, **said)["state"]
    sent = surgeon.upload_image(
        "application/dicom", make_xray(rows=256, columns=300, seed=seed, StudyInstanceUID=study)
    )
    assert _arrival(case, sent["id"])["state"] == state
    assert surgeon.image(sent["id"])["case_id"] == case.id
    stated = surgeon.upload_image("image/png", _picture(_grey(seed + 1)))
    answer = case.command("image-identity-stated", image_id=stated["id"], patient_id="P1")
    assert answer["state"] == state
    assert case.status()["images"] == 2
    foreign = surgeon.upload_image("application/dicom", make_xray(rows=256, columns=300, seed=seed + 2, PatientID="P9"))
    for _ in range(200):
        if surgeon.image(foreign["id"])["purpose"]:
            break
        time.sleep(0.02)
    assert (surgeon.image(foreign["id"])["purpose"], surgeon.image(foreign["id"])["case_id"]) == ("unassigned", None)
