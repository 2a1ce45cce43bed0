"""The stream over HTTP: alive while nothing happens, and over with the session that it belongs to."""

from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest

from service.auth.permissions import Role
from service.auth.users import UserStore
from service.auth.uses import SessionUses
from service.cases import store
from service.cases.records import NewCase, NewEvent
from service.conductor import events
from tests.service.conftest import CHEAP_HASHER

_EVENT = NewEvent("noted", None, "closed", {}, {}, changes_state=False)


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(events, "_KEEP_ALIVE_S", 0.05)
    monkeypatch.setattr(events, "_CHECK_S", 0.05)


@pytest.fixture(scope="module")
def users(running):
    return UserStore(running.parts.database, CHEAP_HASHER)


@pytest.fixture
def case(running, users, request):
    opened_by = users.list()[0].id
    new = NewCase(request.node.name, "room-1", "P1", "1", opened_by, "0" * 64, {}, {})
    with running.parts.database.write() as connection:
        store.open_case(connection, new, _EVENT)
    return new.id


@contextmanager
def _lines(running, case_id: str, token: str) -> Iterator[Iterator[str]]:
    headers = {"Authorization": f"Bearer {token}", "Last-Event-ID": "1"}
    with httpx.stream("GET", f"{running.url}/api/cases/{case_id}/events", headers=headers, timeout=30) as response:
        response.raise_for_status()
        yield response.iter_lines()


def test_a_comment_comes_while_nothing_happens(running, case):
    with _lines(running, case, running.tokens[Role.SURGEON]) as lines:
        assert [next(lines) for _ in range(4)] == [":", "", ":", ""]


def test_an_event_id_that_no_case_has_is_refused_before_the_stream_begins(running, case):
    headers = {"Authorization": f"Bearer {running.tokens[Role.SURGEON]}", "Last-Event-ID": "9" * 40}
    response = httpx.get(f"{running.url}/api/cases/{case}/events", headers=headers, timeout=30)
    assert (response.status_code, response.json()["code"]) == (422, "malformed_request")


def test_signing_out_ends_the_stream_before_the_next_event(running, case, users):
    token = running.parts.sessions.create(users.list()[0])[0]
    with _lines(running, case, token) as lines:
        next(lines)
        running.parts.sessions.revoke(token)
        with running.parts.database.write() as connection:
            store.append(connection, case, _EVENT, expected_version=None)
        assert not [line for line in lines if line.startswith("data:")]


def test_the_stream_of_a_user_who_is_disabled_ends(running, case, users):
    user = users.add("leaving", Role.OPERATOR, "correct horse", "2468")
    with _lines(running, case, running.parts.sessions.create(user)[0]) as lines:
        next(lines)
        users.disable("leaving")
        assert set(lines) <= {":", ""}


def test_a_stream_does_not_keep_its_session_from_locking(running, case, users, monkeypatch):
    noted = []
    monkeypatch.setattr(SessionUses, "note", lambda _uses, session_id, _at_s: noted.append(session_id))
    monkeypatch.setattr("service.auth.sessions._SEEN_STEP_S", -1.0)  # every use is noted
    with _lines(running, case, running.tokens[Role.SURGEON]) as lines:
        next(lines)
        at_first = len(noted)
        assert [next(lines) for _ in range(10)]
    assert (at_first, len(noted)) == (1, 1)
