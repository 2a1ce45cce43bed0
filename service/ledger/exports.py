"""The ledger as files: JSON Lines with every entry whole, CSV for a person to read, DICOM and FHIR audit events."""

import csv
import io
import json
from collections.abc import Callable, Iterator, Mapping
from enum import StrEnum
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.ledger.audit_terms import Subject
from service.ledger.dicom_audit import audit_message
from service.ledger.listing import Wanted, page

_A_TIME = 1000
_COLUMNS = (
    "sequence",
    "recorded_at",
    "actor_name",
    "role",
    "client",
    "action",
    "case_id",
    "before",
    "after",
    "code",
    "message",
    "refused_by",
    "artefacts",
    "sha256",
    "about",
)
# What of an entry's payload has a column of its own, or says the same as one.
_TOLD = ("accepted", "code", "message", "refused_by")
# A spreadsheet would run a cell that begins so.
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


class ExportFormat(StrEnum):
    """What an export is written as."""

    JSONL = "jsonl"
    CSV = "csv"
    DICOM = "dicom"  # a message a line, each a document of its own
    FHIR = "fhir"  # a resource a line


MEDIA_TYPES = {
    ExportFormat.JSONL: "application/x-ndjson",
    ExportFormat.CSV: "text/csv",
    ExportFormat.DICOM: "text/plain",
    ExportFormat.FHIR: "application/fhir+ndjson",
}
Page = list[dict[str, Any]]
Write = Callable[[dict[str, Any], Subject | None], str]


def export(
    database: Database, wanted: Wanted, form: ExportFormat, after: int = 0, limit: int | None = None
) -> Iterator[str]:
    """Every entry that is wanted, a line each; read in pages, so that no view of the database is held open.

    Raises ServiceError EXTRA_MISSING, before the first line, where the format needs what is not installed.
    """
    return _lines(_writer(form), form, _pages(database, wanted, after, limit))


def _lines(write: Write, form: ExportFormat, pages: Iterator[tuple[Page, Mapping[str, Subject]]]) -> Iterator[str]:
    if form is ExportFormat.CSV:
        yield _csv_line(_COLUMNS)
    for entries, subjects in pages:
        yield "".join(write(entry, subjects.get(entry["case_id"])) for entry in entries)


def _pages(
    database: Database, wanted: Wanted, after: int, limit: int | None
) -> Iterator[tuple[Page, Mapping[str, Subject]]]:
    left = limit
    while left is None or left > 0:
        with database.read() as connection:
            entries = page(connection, wanted, after, _A_TIME if left is None else min(left, _A_TIME))
            subjects = _subjects(connection, entries)
        if not entries:
            return
        yield entries, subjects
        after, left = entries[-1]["sequence"], None if left is None else left - len(entries)


def _subjects(connection: Connection, entries: Page) -> Mapping[str, Subject]:
    """Whom the cases of a page are about."""
    cases = tables.cases.c
    query = sa.select(cases.id, cases.patient_id, cases.study_uid).where(cases.id.in_({e["case_id"] for e in entries}))
    return {row.id: Subject(row.patient_id, row.study_uid) for row in connection.execute(query)}


def _writer(form: ExportFormat) -> Write:
    match form:
        case ExportFormat.JSONL:
            return _json_line
        case ExportFormat.CSV:
            return _csv_entry
        case ExportFormat.DICOM:
            return audit_message
        case ExportFormat.FHIR:
            return _fhir_writer()


def _fhir_writer() -> Write:
    try:
        from service.ledger.fhir_audit import audit_event
    except ImportError as error:
        raise ServiceError(ErrorCode.EXTRA_MISSING, "this format needs the extra `fhir`") from error
    return audit_event


def _json_line(entry: dict[str, Any], _: Subject | None) -> str:
    return json.dumps(entry, sort_keys=True, ensure_ascii=False) + "\n"


def _csv_entry(entry: dict[str, Any], _: Subject | None) -> str:
    flat = entry["payload"] | entry | {"about": _about(entry["payload"])}
    return _csv_line([_cell(flat.get(name)) for name in _COLUMNS])


def _about(payload: dict[str, Any]) -> list[str]:
    """What an entry says of its object, as `name=berta role=surgeon`; what is nested is left to JSON Lines."""
    told = {name: one for name, one in payload.items() if name not in _TOLD and not isinstance(one, dict)}
    return [f"{name}={_joined(one)}" for name, one in sorted(told.items()) if one is not None]


def _joined(value: Any) -> str:
    return ",".join(map(str, value)) if isinstance(value, list) else str(value)


def _cell(value: Any) -> str:
    text = " ".join(map(str, value)) if isinstance(value, list) else "" if value is None else str(value)
    return f"'{text}" if text.startswith(_FORMULA) else text


def _csv_line(cells: Any) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(cells)
    return line.getvalue()
