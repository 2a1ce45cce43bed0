"""The ledger as files: JSON Lines with every entry whole, CSV with what a person reads."""

import csv
import io
import json
from collections.abc import Callable, Iterator
from enum import StrEnum
from typing import Any

from service.database.engines import Database
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
)
# A spreadsheet would run a cell that begins so.
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


class ExportFormat(StrEnum):
    """What an export is written as."""

    JSONL = "jsonl"
    CSV = "csv"


MEDIA_TYPES = {ExportFormat.JSONL: "application/x-ndjson", ExportFormat.CSV: "text/csv"}


def export(
    database: Database, wanted: Wanted, form: ExportFormat, after: int = 0, limit: int | None = None
) -> Iterator[str]:
    """Every entry that is wanted, a line each; read in pages, so that no view of the database is held open."""
    if form is ExportFormat.CSV:
        yield _csv_line(_COLUMNS)
    for entries in _pages(database, wanted, after, limit):
        yield "".join(map(_WRITERS[form], entries))


def _pages(database: Database, wanted: Wanted, after: int, limit: int | None) -> Iterator[list[dict[str, Any]]]:
    left = limit
    while left is None or left > 0:
        with database.read() as connection:
            entries = page(connection, wanted, after, _A_TIME if left is None else min(left, _A_TIME))
        if not entries:
            return
        yield entries
        after, left = entries[-1]["sequence"], None if left is None else left - len(entries)


def _json_line(entry: dict[str, Any]) -> str:
    return json.dumps(entry, sort_keys=True, ensure_ascii=False) + "\n"


def _csv_entry(entry: dict[str, Any]) -> str:
    flat = entry["payload"] | entry
    return _csv_line([_cell(flat.get(name)) for name in _COLUMNS])


def _cell(value: Any) -> str:
    text = " ".join(map(str, value)) if isinstance(value, list) else "" if value is None else str(value)
    return f"'{text}" if text.startswith(_FORMULA) else text


def _csv_line(cells: Any) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(cells)
    return line.getvalue()


_WRITERS: dict[ExportFormat, Callable[[dict[str, Any]], str]] = {
    ExportFormat.JSONL: _json_line,
    ExportFormat.CSV: _csv_entry,
}
