"""Whose hand may hold: heartbeats reach the guard only from who has control (H15)."""

import asyncio
from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import pytest

from service.auth.dependencies import COOKIE
from service.auth.session import SessionStatus
from service.cases import store
from service.conductor.caller import Caller
from service.errors import ErrorCode, ServiceError
from service.motion import hold


@pytest.fixture
def goal_of(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The goal that a held button is told, where session `holder` has control under token 2 and the permit is p."""

    def refuse(*_: Any) -> None:
        raise ServiceError(ErrorCode.LEASE_LOST, "control is held elsewhere")

    lease = SimpleNamespace(session_id="holder", fencing_token=2)
    monkeypatch.setattr(hold, "lease_of", lambda _connection, _case_id: lease)
    monkeypatch.setattr(hold, "start_move", refuse)
    monkeypatch.setattr(hold, "goal_of_permit", lambda *_: "goal")
    database = SimpleNamespace(read=lambda: nullcontext())
    case = SimpleNamespace(permit=SimpleNamespace(id="p"))
    conductor = SimpleNamespace(parts=SimpleNamespace(database=database), case_of=lambda _case_id: case)
    conductor.rules = SimpleNamespace(room="room-1")
    monkeypatch.setattr(store, "newest_event", lambda *_: None)

    def ask(session_id: str, control_token: int | None, permit_id: str = "p", room: str = "room-1") -> Any:
        monkeypatch.setattr(store, "read_case", lambda *_: SimpleNamespace(room=room))
        caller = Caller(SimpleNamespace(id=session_id), "case", None, None, control_token)
        return hold._goal(conductor, caller, permit_id)

    return ask


def test_who_has_control_may_hold(goal_of) -> None:
    assert goal_of("holder", 2) == "goal"


@pytest.mark.hazard("H15")
@pytest.mark.parametrize(("session_id", "control_token"), [("another", 2), ("holder", 1), ("holder", None)])
def test_a_hand_without_control_is_refused_before_its_first_heartbeat(goal_of, session_id, control_token) -> None:
    with pytest.raises(ServiceError) as caught:
        goal_of(session_id, control_token)
    assert caught.value.code == ErrorCode.LEASE_LOST


def test_another_permit_is_refused(goal_of) -> None:
    with pytest.raises(ServiceError):
        goal_of("holder", 2, "foreign")


@pytest.mark.hazard("H19")
def test_a_hand_on_a_case_of_another_room_is_refused_before_its_first_heartbeat(goal_of) -> None:
    with pytest.raises(ServiceError) as caught:
        goal_of("holder", 2, room="room-2")
    assert caught.value.code == ErrorCode.CASE_ELSEWHERE


@pytest.mark.hazard("H27")
@pytest.mark.parametrize(
    ("status", "code"),
    [
        (SessionStatus.LOCKED, ErrorCode.SESSION_LOCKED),
        (SessionStatus.EXPIRED, ErrorCode.SESSION_EXPIRED),
        (None, ErrorCode.NOT_SIGNED_IN),
    ],
)
def test_a_session_that_ended_since_the_button_was_drawn_starts_nothing(monkeypatch, status, code) -> None:
    started: list[str] = []
    monkeypatch.setattr(hold, "_is_live", lambda _: True)
    monkeypatch.setattr(hold, "start_move", lambda *_: started.append("a motion"))
    found = None if status is None else SimpleNamespace(status=status)
    parts = SimpleNamespace(sessions=SimpleNamespace(find=lambda _token: found))
    conductor = SimpleNamespace(parts=parts, live=None)
    socket = SimpleNamespace(headers={}, cookies={COOKIE: "token"})
    caller = Caller(SimpleNamespace(id="holder"), "case", None, None, 2)
    ending = asyncio.run(hold._start(hold._Hold(socket, conductor, caller, "p", "goal")))
    assert (ending.cause, ending.problem["code"]) == ("refused", code)
    assert started == []


def _live(permit: str | None, running_under: str | None = None, case_id: str = "case") -> SimpleNamespace:
    running = None if running_under is None else SimpleNamespace(id="motion")
    issued = None if permit is None else SimpleNamespace(id=permit)
    return SimpleNamespace(case_id=case_id, permit=issued, running=running, used_permit_id=running_under)


@pytest.mark.hazard("H15")
@pytest.mark.parametrize(
    ("live", "heard"),
    [
        (_live("p"), True),
        (_live(None, "p"), True),
        (_live("newer"), False),
        (_live(None, "newer"), False),
        (_live(None), False),
        (_live("p", case_id="another"), False),
        (None, False),
    ],
)
def test_only_the_newest_permit_and_that_of_the_motion_under_way_are_heard(live, heard) -> None:
    passed_on: list[Any] = []
    words = iter(['{"number": 1, "challenge": "c", "held": true}', '{"number": 2, "challenge": "d", "held": false}'])

    async def receive_text() -> str:
        return next(words, "no heartbeat")

    async def close(code: int, _reason: str) -> None:
        closed.append(code)

    closed: list[int] = []
    bridge = SimpleNamespace(heartbeat=passed_on.append)
    caller = Caller(SimpleNamespace(id="holder"), "case", None, None, 2)
    socket = SimpleNamespace(receive_text=receive_text, close=close)
    asyncio.run(hold._forward(hold._Hold(socket, SimpleNamespace(bridge=bridge, live=live), caller, "p", "goal")))
    assert [beat.held for beat in passed_on] == ([True, False] if heard else [])
    assert closed == [1008]  # what is no heartbeat ends the hold, and its sender is told so
