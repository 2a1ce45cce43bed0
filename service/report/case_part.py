"""The first page as data: whose case, its outcome by targets, the totals, the devices."""

from collections.abc import Iterator, Sequence
from typing import Any

from service.report.course import TargetWork
from service.report.record import CaseRecord
from service.report.totals import Exposures, Totals
from service.report.wording import NOT_TOLD, NOTHING, figure, lasted, moment, person_name, words
from workflow.triggers import Trigger

Row = list[str]
PASS, FAIL, NONE = "PASS", "FAIL", "NOT VERIFIED"
_PUBLISHED = (
    "4",
    "30",
    "7.5",
    "3.5 to the evaluation, 8.8 to the implanted screw",
    "0.94°",
    "1.31\N{NO-BREAK SPACE}mm",
)


def head(record: CaseRecord) -> dict[str, str]:
    """What stands on every page, and the case's state in a word."""
    state = record.last.state
    over = {"closed": "CLOSED", "aborted": "ABORTED"}
    return {
        "case_id": record.case.id,
        "patient": person_name(record.identity.get("PatientName")),
        "patient_id": record.case.patient_id,
        "state": over.get(state, "OPEN"),
        "state_words": _state_words(record),
        "program": f"Coaxial {record.case.product_version}",
        "as_of": f"event {record.last.sequence} of {moment(record.last.recorded_at)} UTC",
    }


def _state_words(record: CaseRecord) -> str:
    last, state = record.last, record.last.state
    end = next((event for event in record.events if event.state in ("closed", "aborted")), None)
    if end is None:
        return f"The case is still open, in the state “{words(state)}”. This report ends where the record ends today."
    who = f"by {record.person(end.user_id)} at {moment(end.recorded_at)} UTC"
    if state == "aborted":
        return f"Aborted {who}. Reason: {end.data.get('reason') or NOT_TOLD}."
    return f"Closed {who}." if last is end else f"Closed {who}; later events are included."


def facts(record: CaseRecord) -> list[Row]:
    """Label and value of what was fixed when the case was opened, and of the patient as the images name them."""
    case, identity = record.case, record.identity
    return [
        ["Patient", person_name(identity.get("PatientName"))],
        ["Patient id", case.patient_id],
        ["Born, sex", f"{_day(identity.get('PatientBirthDate'))}, {identity.get('PatientSex') or NOT_TOLD}"],
        ["Accession number", str(identity.get("AccessionNumber") or NOT_TOLD)],
        ["Study", case.study_uid],
        ["Case", case.id],
        ["Room", case.room],
        ["Opened", f"{moment(case.opened_at)} UTC by {record.person(case.opened_by)}"],
        ["Program", f"Coaxial {case.product_version}"],
        ["Settings", f"SHA-256 {case.settings_sha256}"],
    ]


def outcomes(record: CaseRecord, course: Sequence[TargetWork]) -> list[Row]:
    """A row per target: what became of it, how it was verified last, and what that took."""
    worked = [_worked(one) for one in course]
    untouched = [name for name in record.planned if name not in {one.name for one in course}]
    return [*worked, *([name, _given_up(record, name), NONE, *[NOTHING] * 6] for name in untouched)]


def _worked(work: TargetWork) -> Row:
    final = work.final
    contour = final.figures["contour"] if final is not None else None
    bounds = contour["predicted_error_95"] if contour is not None else None
    return [
        work.name or "no target chosen",
        result_of(work),
        NONE if final is None else PASS if final.passed else FAIL,
        figure(contour["angle_error_deg"]) if contour else NOTHING,
        figure(bounds["angle_deg"]) if bounds else NOTHING,
        figure(contour["position_error_mm"]) if contour else NOTHING,
        figure(bounds["position_mm"]) if bounds else NOTHING,
        str(len(work.image_ids())),
        lasted(work.seconds),
    ]


def result_of(work: TargetWork) -> str:
    """What became of a target, in words, with the reason where one was given."""
    if work.done is None:
        return "not finished"
    if work.placed:
        return "placed"
    return f"abandoned: {work.done.data['reason'] or NOT_TOLD}"


def _given_up(record: CaseRecord, name: str) -> str:
    closed = next((event for event in record.events if event.trigger == Trigger.CASE_CLOSED), None)
    reason = closed.data.get("abandoned", {}).get(name) if closed is not None else None
    return f"abandoned: {reason}" if reason else "not begun"


def totals_rows(totals: Totals) -> list[Row]:
    """What, here, and as published."""
    here = [
        str(totals.targets_placed),
        str(totals.exposures.images),
        figure(totals.images_per_target, decimals=1),
        figure(totals.minutes_per_target, decimals=1),
        f"{figure(totals.angle_deg, '°')} (paper’s way {figure(totals.paper_angle_deg, '°')})",
        f"{figure(totals.position_mm, 'mm')} (paper’s way {figure(totals.paper_position_mm, 'mm')})",
    ]
    what = ("Targets placed", "Images", "Images per target", "Minutes per target", "Largest angle error")
    rows = [list(row) for row in zip((*what, "Largest position error"), here, _PUBLISHED, strict=True)]
    return [*rows, ["Dose-area product", dose(totals.exposures), NOTHING]]


def dose(exposures: Exposures) -> str:
    """The sum, and of how many images where some were not told."""
    if exposures.dose_dgy_cm2 is None:
        return "not told by the C-arm"
    told = figure(exposures.dose_dgy_cm2, "dGy·cm²")
    whole = exposures.dosed == exposures.images
    return told if whole else f"{told}, told of {exposures.dosed} of {exposures.images} images"


def device_rows(record: CaseRecord) -> list[Row]:
    """Kind, name, version, last day of use, in use since, SHA-256."""
    kinds = {"guide": "Guide", "carm": "C-arm", "tcp": "Tool (TCP)", "room": "Room"}
    return [
        [
            kinds[one.file.kind],
            one.file.name,
            one.file.version,
            one.file.expires or "no last day",
            moment(one.since),
            one.file.sha256,
        ]
        for one in record.devices
    ]


def sources(record: CaseRecord) -> list[str]:
    """What sent the images, as they say themselves."""
    return sorted(set(_sources(record)))


def _sources(record: CaseRecord) -> Iterator[str]:
    for image in record.images.values():
        said = image.stored.metadata
        yield f"{said.get('station', 'station ' + NOT_TOLD)} ({said.get('modality', 'modality ' + NOT_TOLD)})"


def _day(value: Any) -> str:
    text = str(value or "")
    return f"{text[:4]}-{text[4:6]}-{text[6:]}" if len(text) == 8 else NOT_TOLD
