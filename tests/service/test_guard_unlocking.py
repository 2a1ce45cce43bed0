"""When the guard is unlocked: by the newest decision of the room, whichever thread is done first (H18)."""

import time
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from service.conductor.conductor import Conductor
from service.conductor.taking import Prepared, Taken
from service.errors import ServiceError
from service.settings import Settings
from workflow.case import opened
from workflow.decisions import Outcome
from workflow.facts import Restarted
from workflow.states import State
from workflow.triggers import Trigger


class Bridge:
    """A way to a guard that counts how often it was locked and unlocked."""

    watch = None

    def __init__(self) -> None:
        self.unlocked = self.locked = 0
        self.takes = True

    def stop(self, reason: str) -> None:
        self.locked += 1

    def unlock(self) -> bool:
        self.unlocked += 1
        return self.takes


@pytest.fixture
def conductor() -> Any:
    return Conductor(SimpleNamespace(settings=Settings()), Bridge())


def _taken(sequence: int, before: State, after: State, case_id: str = "case") -> Taken:
    case = opened(case_id)
    told = {"trigger": Trigger.NOTE, "row": None, "outcome": Outcome.TAKEN, "verdicts": ()}
    decision = SimpleNamespace(after=replace(case, state=after), effects=(), **told)
    event = SimpleNamespace(case_id=case_id, sequence=sequence)
    return Taken(decision, replace(case, state=before), event, Prepared(Restarted()))


ACKNOWLEDGED = _taken(5, State.SAFE_HOLD, State.CASE_OPEN)


@pytest.mark.hazard("H23")
def test_permits_and_verifications_age_while_the_machine_sleeps(conductor, monkeypatch) -> None:
    """The clock of the system that stands still meanwhile is `time.monotonic`."""
    monkeypatch.setattr("time.clock_gettime", {time.CLOCK_BOOTTIME: 5000.0}.__getitem__)
    assert conductor.rules.clock() == 5000.0


def test_an_acknowledgement_unlocks_the_guard(conductor) -> None:
    conductor._follow(ACKNOWLEDGED)
    assert conductor.bridge.unlocked == 1


def test_an_acknowledgement_that_the_guard_does_not_take_is_told_once_the_rest_is_done(conductor) -> None:
    conductor.bridge.takes, done = False, []
    acknowledged = replace(ACKNOWLEDGED, prepared=Prepared(Restarted(), then=done.append))
    with pytest.raises(ServiceError) as caught:
        conductor._follow(acknowledged)
    assert caught.value.code == "guard_down"
    assert done == [acknowledged.decision]


@pytest.mark.parametrize("state", [State.SAFE_HOLD, State.INSERTING, State.ABORTED])
def test_an_acknowledgement_that_is_overtaken_by_a_newer_lock_unlocks_nothing(conductor, state) -> None:
    conductor._follow(_taken(6, State.CASE_OPEN, state))
    conductor._follow(ACKNOWLEDGED)
    assert conductor.bridge.unlocked == 0


def test_without_any_decision_of_this_run_nothing_is_unlocked(conductor) -> None:
    conductor.unlock()
    assert conductor.bridge.unlocked == 0


def test_a_note_on_a_closed_case_takes_no_other_cases_place(conductor) -> None:
    conductor._follow(_taken(5, State.VERIFIED, State.INSERTING))
    conductor._follow(_taken(90, State.CLOSED, State.CLOSED, "closed long ago"))
    assert conductor.live.state is State.INSERTING


@pytest.mark.hazard("H29")
@pytest.mark.parametrize("state", [State.SAFE_HOLD, State.INSERTING, State.CLOSED])
def test_the_guard_is_locked_whatever_leads_into_a_locked_state(conductor, state) -> None:
    conductor._follow(_taken(6, State.CASE_OPEN, state))
    assert conductor.bridge.locked == 1


def test_a_pause_that_an_acknowledgement_has_overtaken_locks_nothing(conductor) -> None:
    conductor._follow(ACKNOWLEDGED)
    conductor._follow(_taken(4, State.CASE_OPEN, State.SAFE_HOLD))
    assert conductor.bridge.locked == 0
