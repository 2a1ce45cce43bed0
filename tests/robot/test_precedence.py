"""Precedence of the threads that stop the arm: asked for, and gone without where the system grants none (H32)."""

import os
import threading

import pytest

from robot.guard.precedence import Precedence, lift_process, stand_back, take_precedence


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
    take_precedence(Precedence.GUARD, passed_on=passed_on)
    assert asked["setpriority"] == (os.PRIO_PROCESS, 0, -10)
    thread, policy, parameter = asked["sched_setscheduler"]
    assert (thread, policy) == (0, os.SCHED_RR | reset)
    assert parameter.sched_priority == Precedence.GUARD


def test_the_guard_comes_before_the_service_and_the_kernel_before_both() -> None:
    assert 1 <= Precedence.SERVICE < Precedence.GUARD < 50


@pytest.mark.hazard("H32")
def test_without_the_right_to_it_a_thread_runs_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "setpriority", refuse)
    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    before = os.sched_getscheduler(0)
    take_precedence(Precedence.GUARD, passed_on=True)
    lift_process(Precedence.SERVICE)
    assert os.sched_getscheduler(0) == before


@pytest.mark.hazard("H32")
def test_every_thread_of_a_process_is_lifted_but_those_that_have_precedence_and_those_that_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lifted: dict[int, tuple[int, int]] = {}
    ours, gone = threading.get_native_id(), []

    def policy_of(thread: int) -> int:
        if thread == ours:
            return os.SCHED_RR
        if not gone:
            gone.append(thread)
            raise ProcessLookupError
        return os.SCHED_OTHER

    monkeypatch.setattr(os, "sched_getscheduler", policy_of)
    monkeypatch.setattr(os, "setpriority", lambda *_: None)
    monkeypatch.setattr(
        os,
        "sched_setscheduler",
        lambda thread, policy, parameter: lifted.update({thread: (policy, parameter.sched_priority)}),
    )
    over = threading.Event()
    others = [threading.Thread(target=over.wait) for _ in range(3)]
    for other in others:
        other.start()
    lift_process(Precedence.SERVICE)
    over.set()
    expected = {other.native_id for other in others} - set(gone)
    assert len(gone) == 1
    assert expected <= lifted.keys()
    assert not lifted.keys() & {ours, *gone}
    assert set(lifted.values()) == {(os.SCHED_RR, Precedence.SERVICE)}


@pytest.mark.hazard("H32")
def test_image_work_stands_back_whoever_started_it(asked) -> None:
    stand_back(10)
    thread, policy, parameter = asked["sched_setscheduler"]
    assert (thread, policy, parameter.sched_priority) == (0, os.SCHED_OTHER, 0)
    assert asked["setpriority"] == (os.PRIO_PROCESS, 0, 10)
