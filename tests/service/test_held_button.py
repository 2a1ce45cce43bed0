"""Whose hand may hold: heartbeats reach the guard only from who has control (H15)."""

from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import pytest

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

    def ask(session_id: str, control_token: int | None, permit_id: str = "p") -> Any:
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
