"""How fast the ledger is verified, read and written: entries as a procedure makes them, with every row they vouch for.

Prints what the ledger adds to one appended event, the rate of `coaxial audit verify`, and the time of a page at the
beginning and at the end under every filter. Figures of processor time hardly change with other work on the machine.
"""

import argparse
import os
import statistics
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import cycle, islice
from pathlib import Path
from typing import Any
from unittest.mock import patch

import sqlalchemy as sa
from argon2 import PasswordHasher

from benchmarks.kept import at_least_one
from service.audit import record_audit
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.cases import store
from service.cases.attempts import record_attempt
from service.cases.records import ArtefactKind, NewArtefact, NewAttempt, NewCase, NewEvent, NewVerdict
from service.database.engines import Database, open_database
from service.database.migrate import migrate
from service.ledger.anchor import advance_anchor
from service.ledger.draft import begin_draft
from service.ledger.keys import signing_key
from service.ledger.listing import Wanted, page
from service.ledger.sealing import sealed
from service.ledger.verifying import verify

# Trigger, verdicts and artefacts of each transaction of one target, as `coaxial demo` records them.
_PROCEDURE = (
    ("guide_state_stated", 0, 0),
    ("lease_taken", 0, 0),
    ("carm_position_confirmed", 2, 0),
    ("exposure_requested", 6, 0),
    ("image_arrived", 8, 0),
    ("registration_completed", 7, 1),
    ("target_confirmed", 4, 1),
    ("plan_requested", 5, 1),
    ("move_approved", 22, 1),
    ("move_started", 28, 1),
    ("arrived", 0, 1),
    ("exposure_requested", 6, 0),
    ("image_arrived", 9, 0),
    ("verification_passed", 5, 1),
    ("insertion_started", 18, 1),
    ("sleeve_in", 0, 0),
    ("sleeve_removed", 0, 0),
    ("target_done", 0, 0),
    ("signed_in", -1, 0),
    ("log_read", -1, 0),
)
_STATE = {"state": "registered", "chain": dict.fromkeys("abcdefgh", "0" * 32), "text": "x" * 600}
_CONTENT = {"guide_from_source": [[0.123456789012345 + row + column for column in range(4)] for row in range(4)]}
_NUMBERED = {"ledger": "sequence", "attempts": "id", "verdicts": "id"}
_A_TRANSACTION = 500
_CASES = 50
_REPEATS = 15


def main() -> None:
    """Build, then measure."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--count", type=at_least_one, default=20_000, help="entries that are written and verified")
    parser.add_argument("--pages", type=int, default=1_000_000, help="entries that are read in pages, the same again")
    given = parser.parse_args()
    count, pages = given.count, given.pages
    with tempfile.TemporaryDirectory() as name:
        database = _open(Path(name))
        _append_cost(database)
        database.close()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        database = _open(folder)
        with _timed(f"{count} entries written", count):
            _fill(database, count)
        for workers in (1, os.cpu_count() or 1):
            _verify_rate(database, folder, workers)
        _repeat(database, pages)
        _pages(database)
        database.close()


def _open(folder: Path) -> Database:
    signer = signing_key(folder / "audit" / "signing.key")
    database = open_database(f"sqlite:///{folder / 'coaxial.sqlite'}", signer)
    migrate(database)
    surgeon = UserStore(database, PasswordHasher(1, 8, 1)).add("anna", Role.SURGEON, "correct horse", "2468")
    for number in range(_CASES):
        case = NewCase(f"case-{number}", f"room-{number}", "P1", "1", surgeon.id, "0" * 64, {}, {})
        with database.write() as connection:
            store.open_case(connection, case, NewEvent("case_opened", surgeon.id, "case_open", _STATE, {}))
    return database


def _fill(database: Database, count: int) -> None:
    steps = enumerate(islice(cycle(_PROCEDURE), count))
    while some := list(islice(steps, _A_TRANSACTION)):
        with database.writer.begin() as connection:
            for number, step in some:
                with sealed(connection, database.signer):
                    _record(connection, number, *step)


def _record(connection: Any, number: int, trigger: str, verdicts: int, artefacts: int) -> None:
    case_id = f"case-{number // len(_PROCEDURE) % _CASES}"
    if verdicts < 0:
        record_audit(connection, trigger, None, {"session": "0" * 32})
        return
    given = tuple(
        NewVerdict(f"interlock_{one}", f"H{one:02d}", True, 0.123456789 * one, 1.0, "mm", "") for one in range(verdicts)
    )
    record_attempt(connection, NewAttempt(case_id, None, trigger, True, "taken", "", "registered", given))
    made = [NewArtefact(ArtefactKind.PLAN, f"plan-{number}", (), _CONTENT, {}) for _ in range(artefacts)]
    event = NewEvent(trigger, None, "registered", _STATE, {"row": 7, "made": {}}, changes_state=False)
    store.append(connection, case_id, event, expected_version=None, artefacts=made)


def _verify_rate(database: Database, folder: Path, workers: int) -> None:
    signer = database.signer
    assert signer is not None
    advance_anchor(database, folder / "head.json", signer)
    started_s, started_wall_s = _processor_s(), time.monotonic()
    found = verify(database, {signer.verifier.name: signer.verifier}, folder / "head.json", workers)
    took_s, wall_s = _processor_s() - started_s, time.monotonic() - started_wall_s
    assert not found.findings, found.findings[:5]
    print(f"verified {found.entries} entries with {found.rows} rows, {found.checkpoints} checkpoints; ", end="")
    print(f"{workers} at work: ", end="")
    print(f"{found.entries / took_s:.0f} entries/s and {found.rows / took_s:.0f} rows/s of processor, ", end="")
    print(f"{found.entries / wall_s:.0f} entries/s by the wall clock")


def _processor_s() -> float:
    """Processor time of this process and of those that it has ended."""
    return sum(os.times()[:4])


def _repeat(database: Database, wanted: int) -> None:
    """The same entries again, numbered on and a year later each time, for pages: written one by one they take hours."""
    with database.writer.begin() as connection:
        highest = {name: f"SELECT max({key}) FROM {name}" for name, key in _NUMBERED.items()}
        step = {name: connection.exec_driver_sql(query).scalar_one() for name, query in highest.items()}
        for time_ in range(1, wanted // step["ledger"]):
            later = {name: time_ * number for name, number in step.items()}
            connection.exec_driver_sql(
                "INSERT INTO ledger SELECT sequence + ?, entry, sha256, substr(reached_at, 1, 4) + ? "
                "|| substr(reached_at, 5), case_id, actor, action, attempt_id + ? FROM ledger WHERE sequence <= ?",
                (later["ledger"], time_, later["attempts"], step["ledger"]),
            )
            connection.exec_driver_sql(
                "INSERT INTO attempts SELECT id + ?, case_id, user_id, trigger, accepted, code, message, state, "
                "recorded_at FROM attempts WHERE id <= ?",
                (later["attempts"], step["attempts"]),
            )
            connection.exec_driver_sql(
                'INSERT INTO verdicts SELECT id + ?, attempt_id + ?, code, hazard, passed, measured, "limit", unit, '
                "message FROM verdicts WHERE id <= ?",
                (later["verdicts"], later["attempts"], step["verdicts"]),
            )


def _pages(database: Database) -> None:
    with database.read() as connection:
        end = connection.exec_driver_sql("SELECT max(sequence) FROM ledger").scalar_one()
        reached = "SELECT reached_at FROM ledger WHERE sequence = ?"
        early, late = (connection.exec_driver_sql(reached, (int(end * share),)).scalar_one() for share in (0.1, 0.9))
    filters = {
        "no filter": Wanted(),
        "case": Wanted(case_id="case-7"),
        "actor": Wanted(actor="anna"),
        "action": Wanted(action="insertion_started"),
        "interlock, rare": Wanted(interlock="interlock_27"),
        "interlock, frequent": Wanted(interlock="interlock_0"),
        "hazard": Wanted(hazard="H12"),
        "case and action": Wanted(case_id="case-7", action="arrived"),
        "time": Wanted(since=early, until=late),
    }
    print(f"{f'a page of 200 of {end}':32} {'beginning':>12} {'end':>12}   ms of processor, median of {_REPEATS}")
    for name, wanted in filters.items():
        first, last = (_milliseconds(database, wanted, place) for place in (0, int(end * 0.89)))
        print(f"{name:32} {first:12.1f} {last:12.1f}")


def _milliseconds(database: Database, wanted: Wanted, after: int) -> float:
    times = []
    for _ in range(_REPEATS):
        started = time.process_time()
        with database.read() as connection:
            page(connection, wanted, after)
        times.append((time.process_time() - started) * 1000)
    return statistics.median(times)


def _append_cost(database: Database) -> None:
    """An event alone, on a database that ends every commit on the disk, with the ledger and with it left out."""
    figures: dict[str, list[tuple[float, float]]] = {"with": [], "without": []}
    for _ in range(_REPEATS * 4):  # in turns, so that both meet the same disk
        figures["with"].append(_append(database))
        with patch("service.database.engines.sealed", _unsealed), patch("service.cases.store.add_rows", _plain):
            figures["without"].append(_append(database))
    for name, values in figures.items():
        wall, processor = (statistics.median(one) for one in zip(*values, strict=True))
        print(f"an event appended {name} the ledger: {wall:.2f} ms by the wall clock, {processor:.2f} ms of processor")


def _append(database: Database) -> tuple[float, float]:
    event = NewEvent("noted", None, "case_open", _STATE, {})
    started, started_processor = time.perf_counter(), time.process_time()
    with database.write() as connection:
        store.append(connection, "case-0", event, expected_version=None)
    return (time.perf_counter() - started) * 1000, (time.process_time() - started_processor) * 1000


def _plain(connection: Any, table: sa.Table, rows: list[dict[str, Any]]) -> None:
    connection.execute(sa.insert(table), rows)


@contextmanager
def _unsealed(connection: Any, _signer: object) -> Iterator[None]:
    begin_draft(connection)
    yield


@contextmanager
def _timed(what: str, count: int) -> Iterator[None]:
    started_s = time.process_time()
    yield
    took_s = time.process_time() - started_s
    print(f"{what}: {took_s / count * 1e6:.0f} us of processor each", flush=True)


if __name__ == "__main__":
    main()
