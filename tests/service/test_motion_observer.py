"""What the guard says becomes the record: nothing that goes wrong with one event loses the next (H24, H29)."""

import asyncio
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from robot.guard.journal import trajectory_file
from robot.guard.messages import Disturbed, EndCause, Event, Fault, FaultKind, MotionEnded, MoveRefused
from robot.refusal import Refusal, RefusalCode
from service.motion.displacement import Displacement
from service.motion.endings import Endings
from service.motion.observer import MotionObserver
from service.motion.outcomes import outcome_of
from workflow import facts as f
from workflow.states import State
from workflow.triggers import Trigger

ENDED = MotionEnded("p", EndCause.RELEASED, 0.0, True, True, 5.0, 0.1, None, None, "file", 1)
EMERGENCY = Fault(FaultKind.EMERGENCY_STOP, 0.0, "pressed")


class Record:
    """A conductor that remembers what it was told, beside an arm whose drift may be known."""

    def __init__(self, folder: Path, drift: Displacement | None = None, state: State = State.MOVING) -> None:
        self.journal_folder = folder
        self.live = SimpleNamespace(state=state, insertion="sleeve", verification="passed")
        self.bridge = SimpleNamespace(watch=SimpleNamespace(drift=lambda: drift))
        self.told: list[tuple[Trigger, Any]] = []
        self.breaks_on: Trigger | None = None

    def open_case(self) -> str:
        return "case"

    def observe(self, _case_id: str, trigger: Trigger, prepare: Any) -> Any:
        if trigger is self.breaks_on:
            raise ZeroDivisionError("a defect")
        self.told.append((trigger, prepare(None).facts))
        return SimpleNamespace(
            decision=SimpleNamespace(after=SimpleNamespace(state="")), event=SimpleNamespace(version=1)
        )


@pytest.fixture
def hear(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Let an observer record events, each of the motion of permit p."""
    content = {"motion_id": "m", "plan_id": "plan", "kind": "retreat"}
    use = SimpleNamespace(id="p", case_id="case", content=content)
    monkeypatch.setattr(MotionObserver, "_use", lambda _self, _permit_id: use)
    monkeypatch.setattr("service.motion.observer._AGAIN_S", 0.0)

    def run(record: Record, *events: Event) -> list[tuple[Trigger, Any]]:
        async def record_all() -> None:
            observer = MotionObserver(record, Endings())
            for event in events:
                await asyncio.wait_for(observer._record_at_last(event), 5.0)

        asyncio.run(record_all())
        return record.told

    return run


def test_a_trajectory_that_cannot_be_read_loses_neither_the_end_nor_what_follows(hear, tmp_path) -> None:
    (tmp_path / trajectory_file("p")).mkdir()  # reading it is an I/O error
    assert [trigger for trigger, _ in hear(Record(tmp_path), ENDED, EMERGENCY)] == [
        Trigger.RELEASED,
        Trigger.FAULT,
    ]


def test_an_event_that_breaks_its_record_is_a_fault_and_the_next_one_is_heard(hear, tmp_path) -> None:
    record = Record(tmp_path)
    record.breaks_on = Trigger.RELEASED
    kinds = [facts.kind for _, facts in hear(record, ENDED, EMERGENCY)]
    assert kinds == [f.FaultKind.GUARD_LOST, f.FaultKind.EMERGENCY_STOP]


def test_a_motion_refused_because_the_arm_moves_did_not_end_at_rest(hear, tmp_path) -> None:
    refusal = Refusal(RefusalCode.ARM_NOT_AT_REST, "moves", 3.0, 0.5)
    ((_, facts),) = hear(Record(tmp_path), MoveRefused("p", 0.0, refusal))
    assert facts.at_rest is False


@pytest.mark.hazard("H29")
@pytest.mark.parametrize("state", [State.SLEEVE_INSERTED, State.SAFE_HOLD])
def test_a_push_while_a_sleeve_is_in_is_told_where_no_drift_is_watched(hear, tmp_path, state) -> None:
    """After a restart nobody knows where the arm stood when it was verified."""
    pushed = Disturbed(0.0, 2.0, 0.0)
    watched = Record(tmp_path, Displacement(0.1, 0.0), state)
    assert [trigger for trigger, _ in hear(watched, pushed)] == []
    unknown = Record(tmp_path, None, state)
    assert [trigger for trigger, _ in hear(unknown, pushed)] == [Trigger.ARM_DISTURBED]


@pytest.mark.parametrize("cause", [EndCause.ARRIVED, EndCause.MISSED, EndCause.RELEASED])
def test_a_program_that_would_not_stop_is_no_calm_end(cause: EndCause) -> None:
    ended = MotionEnded("p", cause, 0.0, True, False, 0.0, 0.0, None, None, "file", 1)
    assert outcome_of(ended, "m") == (Trigger.FAULT, f.Faulted(f.FaultKind.MOTION_FAULT))
