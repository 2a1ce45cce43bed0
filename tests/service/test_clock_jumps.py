"""The wall clock jumps by a second to a year, forth and back: nothing is decided otherwise, and the record shows it."""

import ast
import json
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from benchmarks.states.races import Contest, contested, opened
from benchmarks.states.room import scripted_room
from service.cases import store
from service.cases.records import StoredEvent
from service.database import clock, tables
from service.ledger.keys import signing_key
from service.ledger.verifying import verify
from workflow.limits import Limits

_THREE_CLIENTS = 31  # a contest of so many
_ROOT = Path(__file__).parents[2]
_JUMPS = [
    pytest.param(sign * timedelta(seconds=seconds), id=f"{sign * seconds:+} s")
    for seconds in (1, 3600, 31_536_000)
    for sign in (1, -1)
]
_WALL = {("time", "time"), ("time", "time_ns"), ("datetime", "now"), ("datetime", "utcnow"), ("date", "today")}


@pytest.fixture(scope="module")
def contest(tmp_path_factory, databases) -> Iterator[Contest]:
    """A case of a room whose monotonic clock stands still until it is told to go on."""
    folder = tmp_path_factory.mktemp("room")
    with databases.empty(folder) as address, scripted_room(folder, address) as room:
        yield opened(room)


@pytest.fixture
def jump(monkeypatch) -> Callable[[timedelta], None]:
    """Sets the wall clock that every record is dated by."""

    def set_by(offset: timedelta) -> None:
        class Set(datetime):
            @classmethod
            def now(cls, tz=None):
                return datetime.now(tz) + offset

        monkeypatch.setattr(clock, "datetime", Set)

    return set_by


@pytest.mark.hazard("H23")
@pytest.mark.parametrize("offset", _JUMPS)
def test_a_permit_lives_by_the_monotonic_clock_alone(contest, jump, offset):
    contest.permit()
    contest.room.clock.now_s += Limits().permit_life_s + 0.1
    contest.room.guard.look()
    jump(offset)
    assert _why_not_started(contest) == {"permit_fresh"}
    contest.permit()
    jump(-offset)
    assert _why_not_started(contest) == set()


@pytest.mark.hazard("H23")
@pytest.mark.parametrize("offset", _JUMPS)
def test_a_motion_amid_a_jump_is_recorded_in_its_order_and_the_jump_with_it(contest, jump, offset):
    before = _events(contest)[-1].sequence
    jump(offset)
    trial = contested(contest, _THREE_CLIENTS)
    jump(timedelta(0))
    contest.command("hold-requested", reason="a pause")
    contest.command("acknowledged", guide="empty")
    assert not trial["bad"], trial
    events = _events(contest)[before:]
    told = ["plan_requested", "move_approved", "move_started", "released", "hold_requested", "acknowledged"]
    assert [event.trigger for event in events] == told
    assert [event.sequence for event in events] == list(range(before + 1, before + 1 + len(told)))
    back_s = _seconds(events[3].recorded_at) - _seconds(events[4].recorded_at)
    assert back_s < offset.total_seconds(), "dates are those of the wall clock, whatever it says"
    run_us = [entry["monotonic_us"] for entry in _entries(contest)]
    assert run_us == sorted(run_us)


@pytest.mark.hazard("H23")
def test_the_ledger_of_a_clock_that_jumped_verifies(contest, jump):
    jump(timedelta(days=-365))
    contest.command("note", text="a year ago")
    jump(timedelta(0))
    parts = contest.room.parts
    verifier, anchor = signing_key(parts.settings.key_file).verifier, parts.settings.anchor_file
    assert contest.room.wait(anchor.exists)
    assert verify(parts.database, {verifier.name: verifier}, anchor).findings == []


@pytest.mark.hazard("H23")
def test_who_is_signed_out_by_a_clock_set_forward_may_still_stop(contest, monkeypatch):
    sessions = contest.room.parts.sessions
    in_a_year = (datetime.now(UTC) + timedelta(days=365)).timestamp()
    monkeypatch.setattr(sessions, "_now_s", lambda: in_a_year)
    token = contest.room.tokens["operator"]
    assert contest.room.line.send("GET", f"/cases/{contest.case_id}", token).code == "session_expired"
    assert contest.room.line.send("POST", "/stop", token, {}).body["recorded"] is True
    monkeypatch.undo()
    assert contest.look() == "safe_hold"
    contest.command("acknowledged", guide="empty")


@pytest.mark.hazard("H23")
@pytest.mark.parametrize("folder", ["workflow", "robot/guard", "service/motion"])
def test_no_rule_and_no_deadline_of_the_guard_asks_the_wall_clock(folder):
    files = sorted((_ROOT / folder).rglob("*.py"))
    assert files
    for file in files:
        asked = {
            (node.value.id, node.attr)
            for node in ast.walk(ast.parse(file.read_text()))
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
        }
        assert not asked & _WALL, file


def _why_not_started(contest: Contest) -> set[str]:
    """What refuses the motion of the case's permit, the held button aside."""
    answer = contest.room.line.send("GET", f"/cases/{contest.case_id}/status", contest.room.tokens["surgeon"])
    return {reason["code"] for reason in answer.body["allowed"]["move_started"]["reasons"]}


def _events(contest: Contest) -> list[StoredEvent]:
    with contest.room.parts.database.read() as connection:
        return store.events_after(connection, contest.case_id)


def _entries(contest: Contest) -> list[dict[str, Any]]:
    ledger = tables.ledger
    with contest.room.parts.database.read() as connection:
        texts = connection.execute(sa.select(ledger.c.entry).order_by(ledger.c.sequence)).scalars()
        entries = [json.loads(text) for text in texts]
    return [entry for entry in entries if entry["run"] == entries[-1]["run"]]


def _seconds(recorded_at: str) -> float:
    return datetime.fromisoformat(recorded_at).timestamp()
