"""The C-arm's own clock as images tell it (H02): a time that is none is unknown, and breaks nothing."""

import pytest

from service.auth.permissions import Role
from service.cases import store
from service.cases.records import NewCase, NewEvent
from service.conductor.arrival import _carm_time, _newer
from service.images.dicom_header import DicomHeader
from service.images.store import NewPurpose, add_image, assign_purpose
from workflow.decisions import ImageUse


@pytest.mark.parametrize("time", ["123456-0500", "12:34:56", "123456x", "1234", "²²²²²²", "", None])
def test_a_time_of_another_form_is_unknown(time):
    assert _carm_time({"acquisition_date": "20260314", "acquisition_time": time}) is None


def test_later_is_later_across_fractions_and_days():
    times = [("20260314", "235959"), ("20260314", "235959.25 "), ("20260315", "000000.5")]
    told = [_carm_time({"acquisition_date": day, "acquisition_time": time}) for day, time in times]
    assert None not in told
    assert sorted(told) == told
    assert len(set(told)) == 3


def test_the_content_speaks_where_the_acquisition_does_not():
    metadata = {"acquisition_date": "20260314", "content_date": "20260314", "content_time": "101112"}
    assert _carm_time(metadata) == ("20260314", 10 * 3600 + 11 * 60 + 12.0)


@pytest.fixture
def arrive(database, users):
    """Let an image arrive that a C-arm took at a time; whether it is newer, as one more image of that case."""
    surgeon = users.add("anna", Role.SURGEON, "correct horse", "2468")
    event = NewEvent("case_opened", surgeon.id, "case_open", {}, {})
    with database.write() as connection:
        for number in (1, 2):
            case = NewCase(f"case-{number}", f"room-{number}", "P1", "1", surgeon.id, "0" * 64, {}, {})
            store.open_case(connection, case, event)

    def one(time: str, case_id: str = "case-1", use: ImageUse = ImageUse.REGISTRATION, station: str = "A"):
        metadata = {"station": station, "acquisition_date": "20260314", "acquisition_time": time}
        with database.write() as connection:
            image = add_image(connection, time.encode(), DicomHeader(None, "P1", "1", None, metadata), None, {})
            newer = _newer(connection, image, case_id)
            assign_purpose(connection, NewPurpose(image.id, case_id, use, {}, ()))
        return newer

    return one


@pytest.mark.hazard("H02")
def test_an_old_image_that_was_refused_lets_no_other_old_one_in_behind_it(arrive):
    assert arrive("100300") is True
    assert arrive("100100", use=ImageUse.QUARANTINED) is False
    assert arrive("100200", use=ImageUse.UNASSIGNED) is False
    assert arrive("100300") is False
    assert arrive("100301") is True


def test_the_newest_image_counts_where_it_was_refused_itself(arrive):
    arrive("100000")
    arrive("100300", use=ImageUse.QUARANTINED)
    assert arrive("100200") is False


def test_the_first_image_of_a_case_is_held_against_the_last_one_before_it(arrive):
    arrive("100300", "case-2")
    assert arrive("100200") is False


def test_another_carms_clock_says_nothing(arrive):
    arrive("100300", station="B")
    assert arrive("100200") is True
