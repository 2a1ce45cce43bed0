"""Images that a case has no use for: quarantined where they may be another patient's; what a person says of them."""

import time
from collections.abc import Callable, Iterator
from itertools import count

import pytest

from coaxial_client import Case, Coaxial, Refused
from service.auth.permissions import Role
from service.images.store import list_images, purpose_of

_TARGETS = [{"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}]
_STUDIES = count(1)


@pytest.fixture
def surgeon(running) -> Iterator[Coaxial]:
    with Coaxial(running.url) as client:
        client.sign_in(Role.SURGEON.value, "correct horse")
        yield client


@pytest.fixture
def open_case(surgeon, device_files) -> Callable[..., Case]:
    for kind, content in device_files.items():
        surgeon.upload_device(kind, content.encode())

    def opened(patient_id: str = "P1") -> Case:
        study = f"1.2.3.{next(_STUDIES)}"
        return surgeon.open_case({"patient_id": patient_id, "study_uid": study, "targets": _TARGETS})

    return opened


@pytest.fixture
def case(open_case) -> Iterator[Case]:
    opened = open_case()
    yield opened
    opened.command("case-aborted", reason="end of the test")


@pytest.fixture
def arrive(surgeon, make_xray) -> Callable[..., str]:
    """An image of somebody arrives and has its purpose; its id."""
    seconds = count(next(_STUDIES) * 1000)

    def one(patient_id: str, study_uid: str = "1.9.9", **elements: object) -> str:
        seed = next(seconds)
        at = {"AcquisitionDate": "20260314", "AcquisitionTime": f"{seed // 3600:02}{seed // 60 % 60:02}{seed % 60:02}"}
        said = {"PatientID": patient_id, "StudyInstanceUID": study_uid, **at, **elements}
        image = surgeon.upload_image("application/dicom", make_xray(256, 300, seed=seed, **said))["id"]
        for _ in range(400):
            if surgeon.image(image)["purpose"] is not None:
                return image
            time.sleep(0.02)
        raise AssertionError("the image was not taken in")

    return one


def _refused(case: Case, image_id: str, **said: object) -> Refused:
    with pytest.raises(Refused) as caught:
        case.command("image-assigned", image_id=image_id, **said)
    return caught.value


def _study(case: Case) -> str:
    return case.room.get(f"/cases/{case.id}")["study_uid"]


_SCOUT = {"purpose": "scout", "reason": "the C-arm still had the name of yesterday", "patient_id": "P1"}


@pytest.mark.hazard("H01")
def test_a_foreign_image_is_quarantined_visible_and_assigned_with_a_reason(surgeon, case, arrive) -> None:
    foreign = arrive("P9")
    seen = next(one for one in surgeon.get_list("/images?purpose=quarantined") if one["id"] == foreign)
    assert {"patient_matches", "study_matches"} <= {one["code"] for one in seen["refused_by"]}
    before = case.status()
    answer = case.command("image-assigned", image_id=foreign, **_SCOUT)
    image, after = surgeon.image(foreign), case.status()
    assert (image["purpose"], image["case_id"], image["patient_id"]) == ("scout", case.id, "P9")
    assert foreign not in {one["id"] for one in surgeon.get_list("/images?purpose=quarantined")}
    assert [after[name] for name in ("state", "chain", "version")] == [
        before[name] for name in ("state", "chain", "version")
    ]
    (record,) = surgeon.get_list(f"/cases/{case.id}/artefacts/image_assignments")
    assert (record["id"], record["made_from"]) == (answer["made"]["image_assignment"], [foreign])
    content = record["content"]
    assert (content["reason"], content["before"]["purpose"]) == (_SCOUT["reason"], "quarantined")
    assert {one["code"] for one in content["verdicts"] if not one["passed"]} == {"patient_matches", "study_matches"}
    assert case.record()[-1]["user_id"] == content["user_id"]


@pytest.mark.hazard("H01")
@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"reason": " "}, "reason_required"),
        ({"patient_id": None}, "patient_differs"),
        ({"patient_id": "P9"}, "patient_differs"),
        ({"purpose": "registration"}, "purpose_refused"),
        ({"purpose": "verification"}, "purpose_refused"),
        ({"purpose": "unassigned"}, "purpose_refused"),
        ({"purpose": "quarantined"}, "purpose_refused"),
        ({"purpose": "anything"}, "malformed_request"),
    ],
)
def test_a_foreign_image_stays_where_it_is_without_all_of_it(surgeon, case, arrive, change, code) -> None:
    foreign = arrive("P9")
    assert _refused(case, foreign, **_SCOUT | change).code == code
    assert surgeon.image(foreign)["purpose"] == "quarantined"
    if code != "malformed_request":
        assert case.attempts()[0]["code"] == code


def test_only_who_takes_images_assigns_them(running, case, arrive) -> None:
    foreign, statuses = arrive("P9"), {}
    for role in Role:
        with running.client(role) as client:
            body = {"image_id": foreign, **_SCOUT}
            statuses[role] = client.post(f"/cases/{case.id}/image-assigned", json=body).status_code
    assert statuses == {Role.SURGEON: 200, Role.OPERATOR: 200, Role.ENGINEER: 403, Role.AUDITOR: 403}


def test_an_image_of_the_case_is_called_a_scout_without_more_and_called_otherwise_later(surgeon, case, arrive) -> None:
    image = arrive("P1", _study(case))
    assert surgeon.image(image)["purpose"] == "unassigned"
    for purpose in ("scout", "depth_check", "scout"):
        case.command("image-assigned", image_id=image, purpose=purpose)
        assert surgeon.image(image)["purpose"] == purpose
    assert [row["content"]["purpose"] for row in surgeon.get_list(f"/cases/{case.id}/artefacts/image_assignments")] == [
        "scout",
        "depth_check",
        "scout",
    ], "every word stays"


def test_a_wrong_word_is_taken_back_with_a_reason_and_the_image_then_belongs_to_nobody(surgeon, case, arrive) -> None:
    foreign = arrive("P9")
    case.command("image-assigned", image_id=foreign, **_SCOUT)
    assert _refused(case, foreign, purpose="quarantined").code == "reason_required"
    case.command("image-assigned", image_id=foreign, purpose="quarantined", reason="it was the neighbour's after all")
    assert surgeon.image(foreign)["purpose"] == "quarantined"
    assert _refused(case, foreign, purpose="depth_check").code == "reason_required"


@pytest.mark.hazard("H01")
def test_the_patient_before_has_a_late_image_while_the_next_case_is_open(surgeon, open_case, arrive) -> None:
    first = open_case("P7")
    study = _study(first)
    first.command("case-aborted", reason="over")
    second = open_case("P8")
    late = arrive("P7", study)
    assert (surgeon.image(late)["purpose"], surgeon.image(late)["case_id"]) == ("quarantined", second.id)
    said = {"purpose": "depth_check", "reason": "sent when the next case was open", "patient_id": "P7"}
    assert _refused(second, late, **said).code == "patient_differs"
    first.command("image-assigned", image_id=late, **said)
    assert late in {one["id"] for one in surgeon.get_list(f"/images?case={first.id}&purpose=depth_check")}
    assert late not in {one["id"] for one in surgeon.get_list(f"/images?case={second.id}")}
    assert _refused(second, late, **said | {"patient_id": "P8"}).code == "image_taken_in"
    second.command("case-aborted", reason="end of the test")


@pytest.mark.hazard("H02")
def test_pixels_that_came_before_and_images_older_than_the_last_are_assigned_to_nobody(surgeon, case, arrive) -> None:
    pixels = bytes(2 * 256 * 300)
    arrive("P1", _study(case), PixelData=pixels)
    again = arrive("P9", PixelData=pixels)
    refused = _refused(case, again, **_SCOUT)
    assert (refused.code, [one["code"] for one in refused.verdicts if not one["passed"]]) == (
        "interlock",
        ["patient_matches", "study_matches", "pixels_unseen"],
    )
    old = arrive("P9", AcquisitionDate="20250101")
    assert "image_newer" in {one["code"] for one in _refused(case, old, **_SCOUT).verdicts if not one["passed"]}
    untimed = arrive("P9", AcquisitionTime="")
    assert "image_newer" in {one["code"] for one in surgeon.image(untimed)["refused_by"]}
    case.command("image-assigned", image_id=untimed, **_SCOUT)


def test_what_nobody_stated_yet_or_is_unknown_is_assigned_to_nobody(surgeon, case, make_xray) -> None:
    waiting = surgeon.upload_image("application/dicom", make_xray(256, 300, seed=77, PatientID=None))["id"]
    assert _refused(case, waiting, **_SCOUT).code == "purpose_undecided"
    assert _refused(case, "none", **_SCOUT).code == "image_unknown"


@pytest.mark.parametrize(
    ("stated", "patient_id", "purpose"),
    [
        (None, "P1", "unassigned"),
        ("unassigned", "P1", "unassigned"),
        ("scout", "P1", "scout"),
        ("depth_check", "P1", "depth_check"),
        ("scout", "P2", "quarantined"),
        ("registration", "P2", "quarantined"),
        ("registration", "P1", None),
        ("verification", "P1", None),
    ],
)
def test_a_person_states_what_an_upload_is_for(surgeon, case, make_xray, stated, patient_id, purpose) -> None:
    unnamed = {"PatientID": None, "StudyInstanceUID": None}
    content = make_xray(256, 300, seed=next(_STUDIES) + 10_000, **unnamed)
    image = surgeon.upload_image("application/dicom", content)["id"]
    if purpose is None:
        with pytest.raises(Refused) as refused:
            case.command("image-identity-stated", image_id=image, patient_id=patient_id, purpose=stated)
        assert (refused.value.code, refused.value.measured) == ("purpose_refused", stated)
    else:
        case.command("image-identity-stated", image_id=image, patient_id=patient_id, purpose=stated)
    assert surgeon.image(image)["purpose"] == purpose


def test_an_assigned_image_is_in_no_chain_and_waits_for_nobody_at_the_next_start(running, case, arrive) -> None:
    foreign = arrive("P9")
    case.command("image-assigned", image_id=foreign, **_SCOUT)
    with running.parts.database.read() as connection:
        assert purpose_of(connection, foreign).arm == {}
        assert foreign in {one.id for one in list_images(connection, case.id, purpose="scout")}
    assert case.status()["chain"]["image"] is None
    assert not case.status()["allowed"]["newest_image_reused"]["allowed"]
