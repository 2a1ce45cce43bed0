"""What each command and list takes in a room with ten thousand closed cases, beside the same room without any.

    python benchmarks/archive.py [--cases 10000] [--times 15] [--folder FOLDER]

One closed case is recorded as a procedure does it, each of its events with an attempt of 22 verdicts; the others are
copies of its rows under other ids, made by the database itself. Their ledger entries are copied too, so that the ledger
is as long as it would be, but its hashes are not theirs: it is not verified here. The services of both rooms answer
turn by turn, so that whatever else the machine does falls on both. FOLDER keeps the databases. Exit status 1 where the
median of a command is above the limit; a list is compared with a room of as many cases as fill its page. Trends, which
are computed of every case, are no list and not timed.
"""

import argparse
import json
import re
import shutil
import sqlite3
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, closing
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from uuid import uuid4

import httpx
from argon2 import PasswordHasher

from benchmarks import recorded_cases
from benchmarks.computed_results import compute
from benchmarks.kept import results_folder
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.cases.attempts import record_attempt
from service.cases.records import NewAttempt, NewVerdict
from service.database import tables
from service.database.current import current_database
from service.settings import Settings
from simulator.demo.child import Child, clean_environment, coaxial
from workflow.states import State

GREATEST_RATIO = 1.5
_PAGE = 250  # cases in the room that lists are compared with; the longest list is of 500 images
_UP_WITHIN_S = 120.0
_PASSWORD, _PIN = "correct horse", "2468"
_VERDICTS = tuple(NewVerdict(f"check_{n}", "H03", True, 12.3456789, 1800.0, "s", "") for n in range(22))
_MARK = "c0a81a1"  # the end of each id of the copied case; a copy has its number there
_ID = re.compile(r"\b[0-9a-f]{32}\b")
_NOT_COPIED = ("device_files", "image_bytes", "audit_events")  # of no case, or shared by all
_COPIED = tuple(table for table in (*tables.RECORDS, tables.ledger) if table.name not in _NOT_COPIED)
# Columns that count through the whole database, and those that point to them.
_NUMBERS = {
    "attempts.id",
    "verdicts.id",
    "verdicts.attempt_id",
    "images.position",
    "ledger.sequence",
    "ledger.attempt_id",
}
_TARGET = {"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}
_REASON, _MOVED = {"reason": "because"}, {"what": "something moved"}
# Facts and requests; without an arm many requests are refused, with all their verdicts recorded.
_COMMANDS: Mapping[str, Mapping[str, Any]] = {
    "guide-state-stated": {"guide": "empty"},
    "carm-moved": _MOVED,
    "patient-moved": _MOVED,
    "hand-guided": _MOVED,
    "device-changed": _MOVED,
    "note": {"text": "a remark"},
    "lease-taken": _REASON,
    "carm-position-confirmed": {},
    "exposure-requested": {},
    "retake": _REASON,
    "plan-requested": {"kind": "retreat", "distance_mm": 20.0},
    "move-approved": {"plan_id": "none", "pin": _PIN},
    "correction-requested": _REASON,
    "insertion-started": {"pin": _PIN},
    "target-withdrawn": _REASON,
    "target-done": {"placed": True},
    "hold-requested": _REASON,
    "acknowledged": {"guide": "empty"},
    "case-closed": {"pin": _PIN},
}
_LISTS = ("/cases", "/images", "/interlocks", "/audit", "/devices")
_READ = ("/status", "/cases/{case}", "/cases/{case}/status", "/cases/{case}/audit", "/interlocks?case={case}")


def settings_of(folder: Path) -> Settings:
    """A room without an arm."""
    return Settings(data_folder=folder, min_free_bytes=0)


def prepare(folder: Path, results: recorded_cases.Results, cases: int) -> None:
    """A data folder with so many closed cases."""
    settings = settings_of(folder)
    with current_database(settings) as database:
        surgeon = UserStore(database, PasswordHasher(1, 8, 1)).add("anna", Role.SURGEON, _PASSWORD, _PIN)
        recording = recorded_cases.Recording(settings, surgeon.id, results, State.CLOSED)
        for number, step in enumerate(recording.steps()):
            if number > 0 and cases == 0:
                return  # the device files alone
            with database.write() as connection:
                step(connection)
                if number > 1:
                    tried = (recording.case.case_id, surgeon.id, "note", True, "taken", "", "case_open", _VERDICTS)
                    record_attempt(connection, NewAttempt(*tried))
    copy_case(Path(str(settings.database_url).removeprefix("sqlite:///")), cases - 1)


def copy_case(file: Path, copies: int) -> None:
    """The rows of the database's one case, so many times more."""
    with closing(sqlite3.connect(file, isolation_level=None)) as connection:
        connection.execute("PRAGMA foreign_keys=OFF")
        connection.execute("CREATE TEMP TABLE copy (i INTEGER PRIMARY KEY)")
        connection.executemany("INSERT INTO copy VALUES (?)", ((number,) for number in range(1, copies + 1)))
        shared = _shared_ids(connection)
        connection.execute("BEGIN")
        for table in _COPIED:
            _copy_rows(connection, table.name, shared)
        connection.execute("COMMIT")


def _shared_ids(connection: sqlite3.Connection) -> set[str]:
    """Ids that every case may name: people and device files."""
    return {row[0] for name in ("users", "device_files") for row in connection.execute(f"SELECT id FROM {name}")}


def _copy_rows(connection: sqlite3.Connection, table: str, shared: set[str]) -> None:
    cursor = connection.execute(f"SELECT * FROM {table}")
    names = [column[0] for column in cursor.description]
    rows = [[_marked(value, shared) for value in row] for row in cursor]
    if table == "ledger":
        rows = rows[1:]  # the one that came with the schema
    quoted = ", ".join(f'"{name}"' for name in names)
    connection.execute(f"CREATE TEMP TABLE model_{table} ({quoted})")
    connection.executemany(f"INSERT INTO model_{table} VALUES ({', '.join('?' * len(names))})", rows)
    chosen = ", ".join(_copied(table, name) for name in names)
    connection.execute(f"INSERT INTO {table} ({quoted}) SELECT {chosen} FROM copy, model_{table} ORDER BY copy.i")
    connection.execute(f"DROP TABLE model_{table}")


def _marked(value: Any, shared: set[str]) -> Any:
    if not isinstance(value, str):
        return value
    return _ID.sub(lambda found: found[0] if found[0] in shared else found[0][: -len(_MARK)] + _MARK, value)


def _copied(table: str, name: str) -> str:
    """The expression of a copy's value."""
    if f"{table}.{name}" in _NUMBERS:
        return f'"{name}" + copy.i * 1000'
    if f"{table}.{name}" in ("images.sop_uid", "images.pixel_sha256"):
        return f'"{name}" || copy.i'
    renamed = f"""replace("{name}", '{_MARK}', printf('%07x', copy.i))"""
    return f"""CASE typeof("{name}") WHEN 'text' THEN {renamed} ELSE "{name}" END"""


@dataclass(frozen=True, slots=True)
class Request:
    """One request of a signed-in surgeon, by what it is called in the table."""

    name: str
    method: str
    path: str
    body: Mapping[str, Any] | None = None
    is_list: bool = False


class Room:
    """The service of one room, signed in, with one open case."""

    def __init__(self, client: httpx.Client) -> None:
        self._client = client
        token = client.post("/api/session", json={"name": "anna", "password": _PASSWORD}).json()["token"]
        self._headers = {"Authorization": f"Bearer {token}"}
        self._case = ""
        self._version = 0
        self.open_case()

    def open_case(self) -> None:
        """A case to be sent commands about."""
        body = {"patient_id": "P2", "study_uid": "1.2.4", "targets": [_TARGET]}
        answer = self._send("POST", "/cases", body)
        self._case, self._version = answer.json()["id"], answer.json()["version"]

    def take(self, request: Request) -> tuple[float, int]:
        """Milliseconds, and the status."""
        path = request.path.format(case=self._case)
        started_s = time.perf_counter()
        answer = self._send(request.method, path, request.body)
        took_ms = (time.perf_counter() - started_s) * 1e3
        if request.method == "POST" and answer.is_success:
            self._version = answer.json().get("version") or self._version
        return took_ms, answer.status_code

    def _send(self, method: str, path: str, body: Mapping[str, Any] | None) -> Any:
        headers = self._headers | {"Idempotency-Key": uuid4().hex, "If-Match": f'"{self._version}"'}
        return self._client.request(method, f"/api{path}", headers=headers, json=body)


def requests() -> Iterator[Request]:
    """Every request that is timed, in an order in which each leaves the case such that the next is answered."""
    for path in _LISTS:
        yield Request(f"GET {path}", "GET", path, is_list=True)
    for path in _READ:
        yield Request(f"GET {path}", "GET", path)
    for name, body in _COMMANDS.items():
        yield Request(name, "POST", f"/cases/{{case}}/{name}", body)
    yield Request("stop", "POST", "/stop")


@dataclass(frozen=True, slots=True)
class Row:
    """A request in both rooms: medians, ms, and the statuses that it was answered with."""

    name: str
    few_ms: float
    full_ms: float
    statuses: tuple[int, ...]

    @property
    def ratio(self) -> float:
        """How much longer it takes with the archive."""
        return self.full_ms / self.few_ms


def measure(few: Room, full: Room, times: int, request: Request) -> Row:
    """One request, turn by turn in both rooms."""
    both = [(few.take(request), full.take(request)) for _ in range(times)]
    medians = [statistics.median(one[place][0] for one in both) for place in (0, 1)]
    return Row(request.name, *medians, tuple(sorted({status for one in both for _, status in one})))


def judged(rows: list[Row], cases: int) -> bool:
    """Print the figures; whether the limit holds for every command and list."""
    print(f"{cases} closed cases; medians in ms")
    for row in rows:
        missed = "" if row.ratio <= GREATEST_RATIO else "  MISSED"
        statuses = ", ".join(map(str, row.statuses))
        print(f"{row.name:36} {row.few_ms:8.1f} {row.full_ms:8.1f}  x {row.ratio:.2f}  ({statuses}){missed}")
    worst = max(rows, key=lambda row: row.ratio)
    print(f"slowest against the small room: {worst.name}, {worst.ratio:.2f} times; at most {GREATEST_RATIO:g}")
    return worst.ratio <= GREATEST_RATIO


def room(stack: ExitStack, folder: Path) -> Room:
    """The service of a data folder, up until the stack closes."""
    environment = clean_environment(COAXIAL_DICOM__PORT="0", COAXIAL_MIN_FREE_BYTES="0")
    command = coaxial("serve", "--data-folder", str(folder), "--port", "0")
    service = stack.enter_context(Child(folder.name, command, folder / "service.log", environment))
    url = service.says("Coaxial listens on ", _UP_WITHIN_S)
    return Room(stack.enter_context(httpx.Client(base_url=url, timeout=_UP_WITHIN_S, trust_env=False)))


@cache
def results_of_a_case() -> recorded_cases.Results:
    """Computed once, where a database is missing."""
    with tempfile.TemporaryDirectory() as place:
        return compute(settings_of(Path(place)))


def prepared(folder: Path, cases: int) -> Path:
    """A copy of the data folder with so many cases, which is made where it is missing."""
    if not folder.exists():
        part = folder.with_suffix(".part")
        shutil.rmtree(part, ignore_errors=True)
        print(f"{cases} cases are made", file=sys.stderr, flush=True)
        prepare(part, results_of_a_case(), cases)
        part.rename(folder)
    used = folder.with_suffix(".used")
    shutil.rmtree(used, ignore_errors=True)
    shutil.copytree(folder, used)
    return used


def main() -> None:
    """Make what is missing, measure, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--times", type=int, default=15, help="each request in each room (default 15)")
    parser.add_argument("--folder", type=results_folder, help="keeps the databases (default: a new temporary one)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary, ExitStack() as stack:
        folder = Path(options.folder or temporary)
        counts = (0, min(_PAGE, options.cases), options.cases)
        empty, page, full = (room(stack, prepared(folder / f"{n}-cases", n)) for n in counts)
        rows = [measure(page if one.is_list else empty, full, options.times, one) for one in requests()]
        (folder / "figures.json").write_text(json.dumps([[row.name, row.few_ms, row.full_ms] for row in rows]))
    sys.exit(0 if judged(rows, options.cases) else 1)


if __name__ == "__main__":
    main()
