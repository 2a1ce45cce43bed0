"""Precedence of the threads that stop the arm: asked for, and gone without where the system grants none (H32)."""

import os

import pytest

from robot.guard.precedence import take_precedence


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> dict[str, tuple]:
    """What was asked of the system, which grants it."""
    asked: dict[str, tuple] = {}
    for name in ("setpriority", "sched_setscheduler"):
        monkeypatch.setattr(os, name, lambda *given, name=name: asked.update({name: given}))
    return asked


@pytest.mark.hazard("H32")
@pytest.mark.parametrize(("passed_on", "reset"), [(True, 0), (False, os.SCHED_RESET_ON_FORK)])
def test_a_thread_runs_before_ordinary_work_and_what_it_starts_only_if_so_wanted(asked, passed_on, reset) -> None:
    take_precedence(passed_on=passed_on)
    assert asked["setpriority"] == (os.PRIO_PROCESS, 0, -10)
    thread, policy, parameter = asked["sched_setscheduler"]
    assert (thread, policy) == (0, os.SCHED_RR | reset)
    assert 1 <= parameter.sched_priority < 50


@pytest.mark.hazard("H32")
def test_without_the_right_to_it_a_thread_runs_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "setpriority", refuse)
    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    before = os.sched_getscheduler(0)
    take_precedence(passed_on=True)
    assert os.sched_getscheduler(0) == before
