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


def export(database: Database, wanted: Wanted, form: ExportFormat, after: int = 0) -> Iterator[str]:
    """Every entry that is wanted, one text a line; read in pages, so that no view of the database is held open."""
    if form is ExportFormat.CSV:
        yield _csv_line(_COLUMNS)
    write = _WRITERS[form]
    while entries := _page(database, wanted, after):
        yield "".join(map(write, entries))
        after = entries[-1]["sequence"]


def _page(database: Database, wanted: Wanted, after: int) -> list[dict[str, Any]]:
    with database.read() as connection:
        return page(connection, wanted, after, _A_TIME)


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
