"""Brings a case from an archive into this database: the same ids, the same contents, vouched for by this ledger now.

Numbers that count within one database are given anew: of arrival of images and device files (which stand before all of
this one's own, so that none becomes the newest here), of attempts.
"""

import json
import time
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection
from sqlalchemy.exc import IntegrityError

from service.archive.checking import check_archive
from service.archive.container import MANIFEST, Archive, open_archive
from service.archive.contents import ARCHIVED, IMPORTED, Row, Rows, contents_of, line
from service.archive.people import add_missing_people
from service.audit import record_audit
from service.cases import store
from service.cases.records import NewEvent
from service.conductor.limits import limits_from
from service.database import tables
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.images.store import keep_bytes
from service.ledger.draft import describe
from service.ledger.entries import sha256_of
from service.ledger.keys import Verifier
from service.ledger.rows import add_rows
from service.settings import Settings
from workflow.case_json import from_json, to_json
from workflow.machine import restarted
from workflow.states import OVER, State

# What counts within one database, and a device's version, which says here where the file came from.
_OWN = {
    "attempts": {"id"},
    "verdicts": {"id", "attempt_id"},
    "deliveries": {"id"},
    "images": {"position", "duplicate_of"},
    "device_files": {"position", "version"},
}
_ARRIVED = (tables.images, tables.device_files)
_BEFORE_ALL = 1_000_000_000  # more than ever arrive, within what PostgreSQL's integer holds


def import_case(
    database: Database, settings: Settings, path: Path, trusted: Mapping[str, Verifier]
) -> tuple[str, bool]:
    """The id of the archive's case, and whether it came new; a live case is held until somebody has looked.

    ServiceError ARCHIVE_REFUSED, CASE_DIFFERS where the case is here with other content, CASE_OPEN where it is live and
    its room has an open case here.
    """
    with open_archive(path) as archive:
        _refuse_unsound(archive, trusted)
        case_id, rows = str(archive.manifest["case_id"]), _rows(archive)
        with database.write() as connection:
            if _is_here(connection, case_id, rows):
                return case_id, False
            _refuse_second_case(connection, rows)
            try:
                _add(connection, archive, case_id, rows)
                _hold(connection, settings, case_id)
            except (KeyError, TypeError, ValueError, IntegrityError) as error:  # sound by itself, and no case of ours
                raise ServiceError(ErrorCode.ARCHIVE_REFUSED, "its rows do not fit into a database") from error
            record_audit(connection, IMPORTED, None, _origin(archive))
            describe(connection, action=IMPORTED, case_id=case_id)
        return case_id, True


def _refuse_unsound(archive: Archive, trusted: Mapping[str, Verifier]) -> None:
    found = check_archive(archive, trusted).findings
    if found:
        raise ServiceError(
            ErrorCode.ARCHIVE_REFUSED, f"{found[0].where}: {found[0].what}", measured=len(found), limit=0
        )


def _rows(archive: Archive) -> Rows:
    return {table.name: archive.objects(f"rows/{table.name}.jsonl") for table in ARCHIVED}


def _origin(archive: Archive) -> dict[str, Any]:
    manifest = archive.manifest
    return {
        "case": manifest["case_id"],
        "manifest_sha256": sha256_of(archive.read(MANIFEST).decode()),
        "key": manifest["key"],
        "pseudonymised": manifest["pseudonymised"] is not None,
    }


def _is_here(connection: Connection, case_id: str, rows: Rows) -> bool:
    """Whether the case is in this database already; it may have gone on here."""
    known = tables.cases.c.id == case_id
    if connection.execute(sa.select(tables.cases.c.id).where(known)).first() is None:
        return False
    here = contents_of(connection, case_id).rows
    for name, some in rows.items():
        missing = Counter(_lines(name, some)) - Counter(_lines(name, here[name]))
        if missing:
            raise ServiceError(
                ErrorCode.CASE_DIFFERS, f"the case is here with other rows of {name}", measured=missing.total(), limit=0
            )
    return True


def _lines(name: str, rows: list[Row]) -> list[bytes]:
    own, columns = _OWN.get(name, set()), tables.metadata.tables[name].columns
    return [
        line({key: _alike(columns.get(key), value) for key, value in row.items() if key not in own}) for row in rows
    ]


def _alike(column: sa.Column[Any] | None, value: Any) -> Any:
    """A value as it is on either kind of database.

    Of JSON that is a bare number PostgreSQL keeps the text; SQLite keeps the number, and of it the first 15 digits (its
    https://www.sqlite.org/datatype3.html, section 3): 120.0 becomes 120, and about one in 15,000 its neighbour.
    """
    if column is None or not isinstance(column.type, sa.JSON) or value is None:
        return value
    meant = json.loads(value) if isinstance(value, str) else value
    is_number = isinstance(meant, float | int) and not isinstance(meant, bool)
    return float(f"{meant:.15g}") if is_number else value


def _add(connection: Connection, archive: Archive, case_id: str, rows: Rows) -> None:
    files = {name.removeprefix("files/").partition(".")[0]: name for name in archive.names if name.startswith("files/")}
    add_missing_people(connection, archive.objects("users.json")[0], case_id)
    inline = {one["sha256"] for some in rows.values() for row in some for one in row.values() if isinstance(one, dict)}
    for sha256 in sorted(files.keys() - inline):
        keep_bytes(connection, archive.read(files[sha256]))
    numbers: dict[int, int] = {}  # of attempts there and here
    for table in tables.metadata.sorted_tables:
        some = sorted(rows.get(table.name, []), key=lambda row: row.get("position", 0))  # the first of duplicates first
        for values in (_values(table, row, archive, files) for row in some):
            if table is tables.attempts:
                number = values.pop("id")
                numbers[number] = int(add_rows(connection, table, [values])[0]["id"])
            elif table is tables.verdicts:
                del values["id"]
                add_rows(connection, table, [values | {"attempt_id": numbers[values["attempt_id"]]}])
            elif table is tables.deliveries:
                del values["id"]
                add_rows(connection, table, [values])
            elif table not in _ARRIVED:
                add_rows(connection, table, [values])
            elif not _is_kept(connection, table, values):
                add_rows(connection, table, [values | _as_older(connection, table, values, case_id)])


def _values(table: sa.Table, row: Row, archive: Archive, files: Mapping[str, str]) -> Row:
    return {key: _value(table.c[key], value, archive, files) for key, value in row.items() if key in table.c}


def _value(column: sa.Column[Any], value: Any, archive: Archive, files: Mapping[str, str]) -> Any:
    if value is None:
        return None
    match column.type:
        case sa.JSON():
            return json.loads(value) if isinstance(value, str) else value  # SQLite keeps a bare number as a number
        case sa.Boolean():
            return bool(value)
        case sa.LargeBinary():
            return archive.read(files[value["sha256"]])
        case _:
            return value


def _is_kept(connection: Connection, table: sa.Table, values: Row) -> bool:
    """Whether an image or a device file of an earlier import is this one."""
    row = connection.execute(sa.select(table.c.sha256).where(table.c.id == values["id"])).first()
    if row is not None and row.sha256 != values["sha256"]:
        raise ServiceError(ErrorCode.CASE_DIFFERS, f"{table.name} {values['id']} is here with other bytes")
    return row is not None


def _as_older(connection: Connection, table: sa.Table, values: Row, case_id: str) -> Row:
    """Stand before everything that arrived here, later arrivals behind earlier ones."""
    place = values["position"] - _BEFORE_ALL
    while connection.execute(sa.select(table.c.id).where(table.c.position == place)).first() is not None:
        place -= 1
    if table is tables.device_files:
        return {"position": place, "version": f"{values['version']} (imported with {case_id[:8]})"}
    first = values["duplicate_of"]
    known = first and connection.execute(sa.select(table.c.id).where(table.c.id == first)).first()
    return {"position": place, "duplicate_of": first if known else None}


def _hold(connection: Connection, settings: Settings, case_id: str) -> None:
    """A case that was under way goes nowhere on another workstation before a person has looked at it."""
    last = store.newest_event(connection, case_id)
    if State(last.state) in OVER:
        return
    decision = restarted(from_json(dict(last.case_state)), time.monotonic(), limits_from(settings.limits))
    data = {
        "told_as": decision.trigger,
        "outcome": decision.outcome,
        "row": decision.row,
        "voided": list(decision.voided),
        "imported": True,
    }
    event = NewEvent(decision.taken_as, None, decision.after.state, to_json(decision.after), data)
    store.append(connection, case_id, event, expected_version=None)


def _refuse_second_case(connection: Connection, rows: Rows) -> None:
    """A room has one open case (H19); here is another that was under way."""
    (case,) = rows["cases"]
    open_id = store.open_case_of(connection, case["room"])
    if open_id is not None and State(rows["events"][-1]["state"]) not in OVER:
        raise ServiceError(ErrorCode.CASE_OPEN, f"room {case['room']} has the open case {open_id}")
