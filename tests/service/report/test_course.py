"""The record cut into targets, its totals, and what the pages say of decisions, stops and people."""

import pytest

from service.report import safety_part
from service.report.case_part import dose, outcomes, totals_rows
from service.report.course import course_of
from service.report.target_part import other_exposures, target_part
from service.report.totals import exposures_of, totals_of
from service.report.wording import figure, lasted, measured, measured_range, person_name, seconds_between, words


def test_each_target_has_its_own_events_and_a_retreat_belongs_to_the_one_before(telling, place):
    place("L3 left", 0.2)
    place("L3 right", 0.3)
    course = course_of(telling.record("L3 left", "L3 right"))
    assert [work.name for work in course] == ["L3 left", "L3 right"]
    assert [[event.data["kind"] for event in work.events if event.trigger == "move_started"] for work in course] == [
        ["targeting", "retreat"]
    ] * 2
    assert sum(len(work.events) for work in course) == len(telling.events) - 1


def test_a_target_that_is_changed_in_the_same_image_is_another(telling):
    image_id = telling.image()
    telling.aim("L3 left", image_id)
    telling.aim("L3 right", image_id)
    assert [work.name for work in course_of(telling.record())] == ["L3 left", "L3 right"]


def test_a_target_without_a_plan_has_a_name_too(telling):
    telling.aim(None, telling.image())
    (work,) = course_of(telling.record())
    assert work.name == "unplanned target"


def test_words_alone_are_no_work_on_a_target(telling):
    telling.tell("note", text="good morning")
    telling.tell("case_closed", state="closed", abandoned={"L3 left": "no time"})
    record = telling.record("L3 left")
    assert course_of(record) == []
    assert outcomes(record, [])[0][:3] == ["L3 left", "abandoned: no time", "NOT VERIFIED"]


def test_totals_are_those_of_the_last_verifications_and_of_placed_targets(telling, place):
    place("L3 left", 0.2, first_mm=1.9)
    place("L3 right", 0.3)
    record = telling.record("L3 left", "L3 right")
    totals = totals_of(record, course_of(record))
    assert (totals.targets_placed, totals.exposures.images, totals.images_per_target) == (2, 5, 2.5)
    assert totals.exposures.dose_dgy_cm2 == pytest.approx(5 * 0.35)
    assert (totals.angle_deg, totals.position_mm, totals.paper_position_mm) == (0.4, 0.3, 0.4)
    first, second = (work.seconds for work in course_of(record))
    assert totals.minutes_per_target == pytest.approx((first + second) / 120.0)
    assert totals_rows(totals)[5][1] == "0.30\N{NO-BREAK SPACE}mm (paper’s way 0.40\N{NO-BREAK SPACE}mm)"


def test_a_correction_shows_the_failed_verification_before_the_passed_one(telling, place):
    place("L3 left", 0.2, first_mm=1.9)
    record = telling.record()
    part = target_part(record, 1, course_of(record)[0], [])
    assert [errors["verdict"] for errors in part["errors"]] == ["FAIL", "PASS"]
    assert part["errors"][0]["rows"][1] == [
        "Position", *(f"{value}\N{NO-BREAK SPACE}mm" for value in ("1.90", "0.12", "2.02", "1.50", "2.00")), "FAIL"
    ]  # fmt: skip
    assert part["errors"][0]["rows"][0][4] == "not told", "no verdict, no limit"
    assert [row[1] for row in part["moves"]] == ["targeting", "corrective", "retreat"]
    assert ["Done", telling.events[-5].recorded_at[11:19]] in part["times"]
    assert part["verdict"] == "PASS"


def test_a_dose_that_nobody_told_is_said_and_one_told_in_part_too(telling):
    for told in (None, 0.25, None):
        telling.image(told)
    images = list(telling.images.values())
    assert dose(exposures_of(images)) == "0.25\N{NO-BREAK SPACE}dGy·cm², told of 1 of 3 images"
    assert dose(exposures_of(images[:1])) == "not told by the C-arm"
    record = telling.record()
    assert [row[5] for row in other_exposures(record, [])] == ["not told", "0.25", "not told"]


def test_verdicts_that_cannot_be_told_apart_are_left_out(telling, place):
    place("L3 left", 0.2)
    telling.decide("verification_passed", None)  # recorded without its event
    (judged,) = course_of(telling.record())[0].judgements
    assert judged.verdicts == {}


def test_what_was_overridden_stopped_and_signed_is_told_with_who_and_why(telling):
    telling.tell("plan_requested", overrides={"image_age": "bone is thin"})
    telling.tell("stop", state="safe_hold", emergency_access=True)
    telling.tell("fault", None, state="safe_hold", cause="heartbeat_lost")
    telling.tell("acknowledged", guide="wire")
    telling.tell("case_closed", state="closed", abandoned={})
    record = telling.record()
    assert [row[1:] for row in safety_part.overrides(record)] == [
        ["anna", "plan requested", "image_age", "bone is thin"]
    ]
    assert [row[1:] for row in safety_part.stops(record)] == [
        ["anna", "stop", "emergency access: the arm was left to the pendant", "safe hold"],
        ["the service", "fault", "heartbeat lost", "safe hold"],
        ["anna", "acknowledged", "guide stated wire", "moved"],
    ]
    assert [row[1:] for row in safety_part.signatures(record)] == [["anna", "closed the case"]]
    assert safety_part.proof(record)[0][1].startswith("no entry here: the case was imported")


def test_every_failed_interlock_is_told_and_all_are_counted(telling):
    verdict = {"code": "angle_error", "hazard": "H28", "limit": 0.01745, "unit": "rad"}
    failed = verdict | {"passed": False, "measured": 0.0349, "message": "too far"}
    telling.decide("plan_requested", "s", failed, accepted=False)
    telling.decide("plan_requested", "s", verdict | {"passed": True, "measured": 0.001, "message": ""})
    telling.decide("plan_requested", "s", verdict | {"passed": False, "measured": None, "message": "unknown"})
    record = telling.record()
    row, unknown = safety_part.failures(record)
    assert row[1:] == ["anna", "plan requested", "refused", ["angle_error: 2°, limit 1°; too far (H28)"]]
    assert safety_part.interlocks(record) == [["H28", "angle_error", "3", "2", "0.057 to 2°, 1 unknown", "1°"]]
    assert unknown[3:] == ["recorded", ["angle_error: unknown, limit 1°; unknown (H28)"]]
    assert safety_part.decided(record) == "3 decisions with 3 verdicts of interlocks; 1 refused."


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("Doe^Jane", "Doe Jane"),
        ("Yamada^Tarou=山田^太郎=やまだ^たろう", "Yamada Tarou (山田 太郎, やまだ たろう)"),
        ("=山田^太郎", "山田 太郎"),
        ("", "not told"),
        ("^^", "not told"),
    ],
)
def test_a_name_is_told_in_all_its_writings(name, told):
    assert person_name(name) == told


def test_figures_have_their_units_and_no_more_digits_than_count():
    assert figure(-0.126, "mm") == "\N{MINUS SIGN}0.13\N{NO-BREAK SPACE}mm"
    assert figure(None, "mm") == "–"
    assert measured(0.0174533, "rad") == "1°"
    assert measured(1e-14, "rad") == "0°"
    assert measured_range([12.0, 353.4], "balls") == "12 to 353\N{NO-BREAK SPACE}balls"
    assert (measured(None, "mm"), measured(True, ""), measured("stated", "")) == ("unknown", "yes", "stated")
    assert words("carm_position_confirmed") == "C-arm position confirmed"


def test_a_clock_that_was_set_back_gives_no_duration():
    later, earlier = "2026-11-22T10:00:05.000000Z", "2026-11-22T10:00:00.000000Z"
    assert seconds_between(earlier, later) == 5.0
    assert lasted(seconds_between(later, earlier)) == "unknown"
    assert lasted(599.6) == "10:00\N{NO-BREAK SPACE}min"
