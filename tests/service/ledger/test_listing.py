"""Reading the ledger: filters, pages, exports; reading is an entry itself."""

import csv
import io
import json

import pytest

from service.audit import record_audit
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.ledger.exports import ExportFormat, export
from service.ledger.listing import Wanted, page
from tests.service.conftest import CHEAP_HASHER


@pytest.fixture
def database(record):
    database = record.open()
    yield database
    database.close()


def _page(database, after=0, limit=1000, **wanted):
    with database.read() as connection:
        return page(connection, Wanted(**wanted), after, limit)


def test_pages_follow_one_another_without_gap_or_overlap(database):
    whole = _page(database)
    assert [entry["sequence"] for entry in whole] == list(range(1, len(whole) + 1))
    for wanted in ({}, {"case_id": "case-1"}, {"actor": "anna"}, {"interlock": "guide_empty"}, {"hazard": "H03"}):
        paged, after = [], 0
        while some := _page(database, after, 3, **wanted):
            paged += some
            after = some[-1]["sequence"]
        assert paged == _page(database, **wanted) != []


@pytest.mark.parametrize(
    ("wanted", "fits"),
    [
        ({"case_id": "case-1"}, lambda entry: entry["case_id"] == "case-1"),
        ({"actor": "anna"}, lambda entry: entry["actor_name"] == "anna"),
        ({"action": "signed_in"}, lambda entry: entry["action"] == "signed_in"),
        ({"interlock": "guide_empty"}, lambda entry: entry["attempt_id"] is not None),
        ({"hazard": "H35", "case_id": "case-2"}, lambda e: e["attempt_id"] is not None and e["case_id"] == "case-2"),
        ({"interlock": "guide_empty", "hazard": "H03"}, lambda entry: False),
        ({"interlock": "none"}, lambda entry: False),
        ({"actor": "nobody"}, lambda entry: False),
    ],
)
def test_a_filter_lets_through_what_fits_and_nothing_else(database, wanted, fits):
    whole = _page(database)
    assert _page(database, **wanted) == [entry for entry in whole if fits(entry)]


@pytest.mark.hazard("H23")
def test_times_are_those_of_a_clock_that_never_goes_back(database, monkeypatch):
    """H23: a clock that was set back hides nothing between two times."""
    for at in ("2040-01-01T00:00:00.000000Z", "2030-01-01T00:00:00.000000Z", "2041-01-01T00:00:00.000000Z"):
        monkeypatch.setattr("service.ledger.entries.now_utc", lambda at=at: at)
        with database.write() as connection:
            record_audit(connection, "late", None, {"at": at})
    found = _page(database, since="2040-01-01T00:00:00.000000Z", until="2041-01-01T00:00:00.000000Z")
    assert [entry["recorded_at"][:4] for entry in found] == ["2040", "2030"]
    assert _page(database, since="2042-01-01T00:00:00.000000Z") == []


def test_exports_hold_every_entry_and_run_no_formula(database):
    with database.write() as connection:
        record_audit(connection, "=cmd()", None, {"message": "@now"})
    whole = _page(database)
    lines = "".join(export(database, Wanted(), ExportFormat.JSONL)).splitlines()
    assert [json.loads(line) for line in lines] == whole
    rows = list(csv.DictReader(io.StringIO("".join(export(database, Wanted(), ExportFormat.CSV)))))
    assert [row["sha256"] for row in rows] == [entry["sha256"] for entry in whole]
    assert (rows[-1]["action"], rows[-1]["message"]) == ("'=cmd()", "'@now")


def test_a_table_says_whom_and_what_each_entry_is_about(database):
    users = UserStore(database, CHEAP_HASHER)
    users.add("berta", Role.OPERATOR, "correct horse", "2468")
    users.disable("berta")
    with database.write() as connection:
        record_audit(connection, "objects_queued", None, {"objects": ["1.2", "1.3"], "code": "x", "none": None})
    with database.write() as connection:
        record_audit(connection, "log_read", None, {"what": "audit", "asked": {"after": 0}})
    text = "".join(export(database, Wanted(), ExportFormat.CSV))
    *_, added, disabled, queued, read = csv.DictReader(io.StringIO(text))
    (user_id,) = [one["payload"]["user_id"] for one in _page(database, action="user_disabled")]
    assert (added["action"], added["about"]) == ("user_added", f"name=berta role=operator user_id={user_id}")
    assert (disabled["action"], disabled["about"]) == ("user_disabled", f"name=berta user_id={user_id}")
    assert (queued["about"], queued["code"]) == ("objects=1.2,1.3", "x")
    assert read["about"] == "what=audit"
    assert text.splitlines()[0].endswith(",sha256,about"), "at the end: who reads by number reads as before"
    assert all("P1" not in row["about"] for row in csv.DictReader(io.StringIO(text)))


def test_reading_over_http_is_an_entry_and_filters_by_query(running):
    with running.client(Role.AUDITOR) as auditor:
        first = auditor.get("/audit", params={"limit": 1}).json()
        assert [entry["sequence"] for entry in first] == [1]
        auditor.get("/interlocks")
        readings = auditor.get("/audit", params={"action": "log_read", "since": "2020-01-01T00:00:00"}).json()
        assert [entry["payload"]["what"] for entry in readings] == ["audit", "interlocks", "audit"]
        assert {(entry["actor_name"], entry["role"]) for entry in readings} == {("auditor", "auditor")}
        exported = auditor.get("/audit/export", params={"format": "csv", "action": "log_read"})
        assert exported.headers["content-type"].startswith("text/csv")
        assert len(exported.text.splitlines()) == 1 + 4
        for bad in ({"limit": 0}, {"limit": 1001}, {"after": -1}, {"since": "yesterday"}, {"case": "x" * 200}):
            assert auditor.get("/audit", params=bad).status_code == 422
