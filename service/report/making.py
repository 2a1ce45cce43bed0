"""Makes the report of a case from its record: read, draw, set."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from service.cases.records import ArtefactKind, Json, StoredArtefact
from service.database.engines import Database
from service.report import case_part, safety_part
from service.report.course import Judgement, TargetWork, course_of
from service.report.record import CaseRecord, read_record
from service.report.target_part import came_of, other_exposures, target_part
from service.report.totals import totals_of
from service.report.wording import clock, figure, words
from service.vision_worker import VisionWorker


@dataclass(frozen=True, slots=True, eq=False)
class _Shown:
    """An image of a target's page: the target in it, and the judgement that it gave, where it gave one."""

    image_id: str
    target: StoredArtefact | None
    judgement: Judgement | None
    goes_on: bool  # a motion was planned from it, so that the goal is drawn


async def make_report(database: Database, vision: VisionWorker, case_id: str) -> bytes:
    """The report as PDF/A, of an open or aborted case too; ServiceError CASE_UNKNOWN, or of the image worker.

    The same record gives the same bytes.
    """
    record = await asyncio.to_thread(_read, database, case_id)
    course = course_of(record)
    targets: list[Json] = []
    pictures: dict[str, str] = {}
    for number, work in enumerate(course, 1):
        shown = _shown(record, work)
        drawn = await vision.run("draw_figures", [_to_draw(record, one) for one in shown])
        files = {f"target-{number}-{place}.svg": svg for place, svg in enumerate(drawn["figures"], 1)}
        pictures |= {file: svg for file, svg in files.items() if svg is not None}
        named = [None if svg is None else file for file, svg in files.items()]
        figures = [_figure(record, one, file) for one, file in zip(shown, named, strict=True)]
        targets.append(target_part(record, number, work, figures))
    answer = await vision.run("typeset", _document(record, course, targets), pictures, record.last.recorded_at)
    return bytes(answer["pdf"])


def _read(database: Database, case_id: str) -> CaseRecord:
    with database.read() as connection:
        return read_record(connection, case_id)


def _shown(record: CaseRecord, work: TargetWork) -> list[_Shown]:
    """What was registered or verified meanwhile, or aimed in, in the order of arrival."""
    aims = {str(one.content["image_id"]): one for one in work.aims}
    judged = {one.image_id: one for one in work.judgements}
    used = {*aims, *judged, *work.image_ids()}
    return [
        _Shown(
            image_id,
            judged[image_id].target if image_id in judged else aims.get(image_id),
            judged.get(image_id),
            image_id in aims,
        )
        for image_id in record.image_bytes
        if image_id in used
    ]


def _to_draw(record: CaseRecord, one: _Shown) -> dict[str, Any]:
    registrations = record.artefacts[ArtefactKind.REGISTRATION].values()
    found = [dict(made.content) for made in registrations if made.columns["image_id"] == one.image_id]
    content = None if one.target is None else one.target.content
    point = None if content is None else {"raw_px": content["raw_px"], "depth_mm": content["depth_mm"]}
    return {
        "content": record.image_bytes[one.image_id],
        "registration": found[-1] if found else None,
        "target": point,
        "with_goal": one.goes_on,
    }


def _figure(record: CaseRecord, one: _Shown, file: str | None) -> dict[str, Any]:
    """File (None where the image could not be drawn), caption and verdict of a picture."""
    at = clock(record.images[one.image_id].stored.received_at)
    if one.judgement is None:
        aimed, became = "Before the motion onto the target", came_of(record, one.image_id)
        caption = f"{aimed}, {at}" if one.target is not None else f"Image of {at}: {became}"
        return {"file": file, "caption": caption, "verdict": ""}
    contour = one.judgement.figures["contour"]
    errors = f"{figure(contour['angle_error_deg'], '°')}, {figure(contour['position_error_mm'], 'mm')}"
    verdict = case_part.PASS if one.judgement.passed else case_part.FAIL
    motion = one.judgement.event.case_state.get("motion")
    kind = f"{words(motion['kind'])} motion" if motion else "motion"
    return {"file": file, "caption": f"After the {kind}, {at}: {errors}", "verdict": verdict}


def _document(record: CaseRecord, course: Sequence[TargetWork], targets: Sequence[Json]) -> dict[str, Any]:
    """Everything that the template prints, as texts."""
    totals = totals_of(record, course)
    return {
        "head": case_part.head(record),
        "facts": case_part.facts(record),
        "outcomes": case_part.outcomes(record, course),
        "totals": case_part.totals_rows(totals),
        "devices": case_part.device_rows(record),
        "sources": case_part.sources(record),
        "targets": list(targets),
        "other_exposures": other_exposures(record, course),
        "decided": safety_part.decided(record),
        "failures": safety_part.failures(record),
        "interlocks": safety_part.interlocks(record),
        "overrides": safety_part.overrides(record),
        "stops": safety_part.stops(record),
        "statements": safety_part.statements(record),
        "signatures": safety_part.signatures(record),
        "proof": safety_part.proof(record),
    }
