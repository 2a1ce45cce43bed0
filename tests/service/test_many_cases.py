"""A room with many cases: pages of them, and queries that find what they look for by an index."""

import pytest
import sqlalchemy as sa

from service.auth.permissions import Role
from service.cases import store
from service.cases.attempts import list_attempts, record_attempt
from service.cases.records import NewAttempt, NewCase, NewEvent, NewVerdict
from service.conductor.check_record import last_check
from service.errors import ServiceError

_ROOM = "room-1"


def _event(state: str) -> NewEvent:
    return NewEvent("noted", None, state, {}, {}, changes_state=False)


@pytest.fixture
def surgeon(users):
    return users.add("anna", Role.SURGEON, "correct horse", "2468")


@pytest.fixture
def opened(database, surgeon):
    """Opens a case, and takes it to a state."""

    def open_case(case_id: str, state: str, room: str = _ROOM) -> None:
        with database.write() as connection:
            new = NewCase(case_id, room, "P1", "1", surgeon.id, "0" * 64, {}, {})
            store.open_case(connection, new, _event("case_open"))
            store.append(connection, case_id, _event(state), expected_version=None)

    return open_case


@pytest.mark.parametrize("last", ["closed", "aborted", "safe_hold"])
def test_the_open_case_is_the_one_that_never_ended(database, opened, last):
    for number in range(5):
        opened(f"case-{number}", ["closed", "aborted"][number % 2])
    opened("elsewhere", "case_open", room="room-2")
    opened("newest", last)
    with database.read() as connection:
        assert store.open_case_of(connection, _ROOM) == ("newest" if last == "safe_hold" else None)
        assert store.open_case_of(connection, "room-2") == "elsewhere"


def test_a_note_on_a_case_that_is_over_opens_nothing(database, opened):
    opened("case", "closed")
    with database.write() as connection:
        store.append(connection, "case", _event("closed"), expected_version=None)
        assert store.open_case_of(connection, _ROOM) is None


def test_pages_of_cases_miss_none_and_repeat_none(database, opened):
    names = [f"case-{number}" for number in range(7)]
    for name in names:
        opened(name, "closed")
    with database.read() as connection:
        pages, before = [], None
        while page := store.list_cases(connection, 3, before):
            pages.append([case.id for case in page])
            before = page[-1].id
        assert [len(page) for page in pages] == [3, 3, 1]
        assert (
            [one for page in pages for one in page] == names[::-1] == [case.id for case in store.list_cases(connection)]
        )
        assert store.standings(connection, names[:2])["case-1"] == {"state": "closed", "version": 1, "sequence": 2}
        with pytest.raises(ServiceError, match="no case none"):
            store.list_cases(connection, 3, "none")


def test_the_open_case_is_listed_though_a_clock_says_that_it_is_old(running):
    parts = running.parts
    with running.client() as client:
        user_id = client.get("/session").json()["user_id"]
        with parts.database.write() as connection:
            for name, state in (("older", "case_open"), ("newer", "closed")):
                new = NewCase(
                    name, parts.settings.room if state == "case_open" else "next", "P1", "1", user_id, "", {}, {}
                )
                store.open_case(connection, new, _event(state))
        assert [case["id"] for case in client.get("/cases?limit=1").json()] == ["newer", "older"]
        assert [case["id"] for case in client.get("/cases?before=newer").json()] == ["older"]


def test_attempts_come_with_their_own_verdicts_in_order(database, opened, surgeon):
    opened("case", "case_open")
    with database.write() as connection:
        for number in range(3):
            given = tuple(NewVerdict(f"{number}-{n}", "H03", True, n, None, "", "") for n in range(number))
            record_attempt(connection, NewAttempt("case", surgeon.id, "note", True, "", "", None, given))
    with database.read() as connection:
        attempts = list_attempts(connection, "case")
    assert [[verdict["code"] for verdict in one["verdicts"]] for one in attempts] == [["2-0", "2-1"], ["1-0"], []]


@pytest.mark.sqlite
def test_what_is_asked_beside_every_command_scans_no_table(database):
    queries = []

    def noted(_connection, _cursor, statement, parameters, _context, _many) -> None:
        queries.append((statement, parameters))

    with database.read() as connection:
        sa.event.listen(connection, "before_cursor_execute", noted)
        store.open_case_of(connection, _ROOM)
        last_check(connection)
        store.list_cases(connection, 100)
        sa.event.remove(connection, "before_cursor_execute", noted)
        plans = [
            step[3]
            for statement, parameters in queries
            for step in connection.exec_driver_sql(f"EXPLAIN QUERY PLAN {statement}", parameters)
        ]
    assert not [step for step in plans if step.startswith("SCAN") and "USING" not in step], plans
    assert not [step for step in plans if "TEMP B-TREE" in step], plans
