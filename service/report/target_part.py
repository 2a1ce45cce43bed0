"""The page of a target as data: figures, errors, moves, exposures."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

from service.cases.records import ArtefactKind, Json, StoredArtefact, StoredEvent
from service.report.case_part import FAIL, NONE, PASS, Row, dose, result_of
from service.report.course import Judgement, TargetWork
from service.report.record import CaseImage, CaseRecord
from service.report.totals import dose_of, exposures_of
from service.report.wording import NOT_TOLD, NOTHING, clock, figure, lasted, measured, moment, seconds_between, words
from workflow.triggers import Trigger

_RESULTS = (
    Trigger.REGISTRATION_COMPLETED,
    Trigger.REGISTRATION_REFUSED,
    Trigger.VERIFICATION_PASSED,
    Trigger.VERIFICATION_FAILED,
    Trigger.VERIFICATION_REFUSED,
)


def target_part(record: CaseRecord, number: int, work: TargetWork, figures: Sequence[Json]) -> dict[str, Any]:
    """One target as the template takes it; `figures` are file and caption of its pictures."""
    end = work.done or work.events[-1]
    images = [record.images[image_id] for image_id in work.image_ids() if image_id in record.images]
    return {
        "title": work.name or "No target chosen",
        "number": str(number),
        "result": result_of(work),
        "verdict": NONE if work.final is None else PASS if work.final.passed else FAIL,
        "took": f"{moment(work.events[0].recorded_at)} to {clock(end.recorded_at)}, {lasted(work.seconds)}",
        "times": list(_times(work)),
        "figures": list(figures),
        "errors": [_errors(number, one) for number, one in enumerate(work.judgements, 1)],
        "moves": [_move(record, event) for event in work.events if event.trigger == Trigger.MOVE_STARTED],
        "exposures": [_exposure(record, one) for one in images],
        "dose": f"Dose-area product: {dose(exposures_of(images))}",
    }


_MILESTONES = {
    Trigger.CARM_POSITION_CONFIRMED: "C-arm",
    Trigger.IMAGE_ARRIVED: "Image",
    Trigger.TARGET_CONFIRMED: "Target",
    Trigger.VERIFICATION_PASSED: "Verified",
    Trigger.INSERTION_STARTED: "Insertion",
    Trigger.SLEEVE_IN: "Sleeve in",
    Trigger.SLEEVE_REMOVED: "Sleeve out",
    Trigger.TARGET_DONE: "Done",
}


def _times(work: TargetWork) -> Iterator[Row]:
    """What was confirmed, taken, chosen, reached, and when: a verification the last time, all else the first time."""
    for trigger, what in _MILESTONES.items():
        reached = [event.recorded_at for event in work.events if event.trigger == trigger]
        last = trigger is Trigger.VERIFICATION_PASSED
        yield [what, clock(reached[-1 if last else 0]) if reached else NOTHING]


def _errors(number: int, one: Judgement) -> dict[str, Any]:
    """A judged verification: both errors with their bound against the limit, both ways, and the other checks."""
    return {
        "title": f"Verification {number}, {clock(one.event.recorded_at)}",
        "verdict": PASS if one.passed else FAIL,
        "depth": figure(one.target.content["depth_mm"], "mm", decimals=0),
        "rows": [
            _error(one, "Angle", "angle_error", "angle_error_deg", "angle_deg", "°"),
            _error(one, "Position", "position_error", "position_error_mm", "position_mm", "mm"),
        ],
        "checks": list(_checks(one)),
    }


def _error(one: Judgement, what: str, interlock: str, error: str, bound: str, unit: str) -> Row:
    contour, paper, verdict = one.figures["contour"], one.figures["paper"], one.verdicts.get(interlock)
    bound_95 = contour["predicted_error_95"][bound]
    return [
        what,
        figure(contour[error], unit),
        figure(bound_95, unit),
        figure(contour[error] + bound_95, unit),
        NOT_TOLD if verdict is None else figure(_in_unit(verdict["limit"], unit), unit),
        figure(paper[error], unit),
        "" if verdict is None else PASS if verdict["passed"] else FAIL,
    ]


def _in_unit(limit: float, unit: str) -> float:
    return math.degrees(limit) if unit == "°" else limit


_CHECKS = {
    "evaluations_agree": "Both evaluations agree",
    "motion_agrees": "Guide moved in the images as the arm says (chi-square)",
    "anatomy_across": "Anatomy kept its place across the beam",
    "anatomy_along": "Anatomy kept its place along the beam",
}


def _checks(one: Judgement) -> Iterator[Row]:
    for code, what in _CHECKS.items():
        verdict = one.verdicts.get(code)
        if verdict is not None:
            value, limit = (measured(verdict[name], verdict["unit"]) for name in ("measured", "limit"))
            yield [what, value, limit, PASS if verdict["passed"] else FAIL]


def _move(record: CaseRecord, started: StoredEvent) -> Row:
    """When, why, how far, how it ended, how long the button was held, how far from the goal it stopped."""
    plan = record.artefacts[ArtefactKind.PLAN][started.data["plan_id"]].content
    motion = record.artefacts[ArtefactKind.MOTION].get(started.data["motion_id"])
    planned = [figure(plan["length_mm"], decimals=1), figure(plan["rotation_deg"])]
    opening = [clock(started.recorded_at), words(started.data["kind"]), *planned]
    if motion is None:
        return [*opening, "no end recorded", NOTHING, NOTHING]
    held = seconds_between(started.recorded_at, motion.recorded_at)
    short = motion.content.get("distance_mm")
    return [*opening, _ending(motion), figure(held, decimals=1), figure(short)]


def _ending(motion: StoredArtefact) -> str:
    cause = words(motion.content["cause"])
    return f"{cause} ({motion.content['code']})" if "code" in motion.content else cause


def _exposure(record: CaseRecord, image: CaseImage) -> Row:
    """When, what for, the C-arm's angles, tube voltage, time, dose, what came of it."""
    said = image.stored.metadata
    angles = [figure(said.get(f"positioner_{axis}_deg"), decimals=1) for axis in ("primary", "secondary")]
    return [
        clock(image.stored.received_at),
        words(image.purpose.purpose),
        NOT_TOLD if angles == [NOTHING] * 2 else " / ".join(angles),
        _told(said.get("tube_voltage_kv"), 0),
        _told(said.get("exposure_time_ms"), 0),
        _told(dose_of(image), 2),
        came_of(record, image.stored.id),
    ]


def _told(value: float | None, decimals: int) -> str:
    return NOT_TOLD if value is None else figure(value, decimals=decimals)


def came_of(record: CaseRecord, image_id: str) -> str:
    """What an image was registered, verified or refused as."""
    events = [event for event in record.events if event.trigger in _RESULTS and event.data.get("image_id") == image_id]
    return "; ".join(_result(event) for event in events) or "not evaluated"


def _result(event: StoredEvent) -> str:
    said = event.data
    match event.trigger:
        case Trigger.REGISTRATION_COMPLETED:
            return f"registered, residual {figure(said.get('residual_rms_px'), 'px')}"
        case Trigger.VERIFICATION_PASSED | Trigger.VERIFICATION_FAILED:
            return words(event.trigger)
        case _:
            # Of one that the rules refused, earlier versions recorded no reason beside its verdicts.
            return f"refused: {words(said['reason']['code'])}" if "reason" in said else "refused"


def other_exposures(record: CaseRecord, course: Sequence[TargetWork]) -> list[Row]:
    """Images of the case that arrived outside the work on any target."""
    told = {image_id for work in course for image_id in work.image_ids()}
    return [_exposure(record, image) for image_id, image in record.images.items() if image_id not in told]
