"""What the guard looks through: only good readings pass, and a lost arm is looked for at once and then each second."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from robot.arm import ArmState
from robot.guard.messages import FaultKind
from robot.guard.observer import Observer
from robot.safety import SafetyState

At = Callable[..., ArmState]


def watching(readings: Iterable[ArmState | None]) -> Observer:
    told = iter(readings)
    return Observer(SimpleNamespace(read=lambda: next(told)))


def test_an_arm_is_looked_for_at_once_however_young_the_machine_and_then_once_a_second() -> None:
    looked: list[float] = []
    observer = Observer(SimpleNamespace(connect=lambda: bool(looked.append(now_s))))
    for now_s in (0.0, 0.5, 0.999, 1.0, 1.5, 2.0):
        observer.keep_connected(now_s)
    assert looked == [0.0, 1.0, 2.0]


@pytest.mark.hazard("H21")
def test_a_reading_that_is_no_good_is_judged_by_nobody(at: At) -> None:
    good, broken = at(1.0), replace(at(1.008, speed_mm_s=5.0), joints_rad=np.full(6, np.nan))
    observer = watching([good, at(1.5), broken, None, at(1.508)])
    assert observer.read() is good
    observer.read()
    assert (observer.read(), observer.rest_s) == (None, 0.5)
    assert observer.fault(1.5) is FaultKind.FEEDBACK_LOST
    assert (observer.read(), observer.is_sound(1.5)) == (None, False)
    assert observer.read() is not None
    assert observer.fault(1.508) is None
    assert observer.rest_s == pytest.approx(0.508)  # what was no good did not end it


def test_before_its_first_reading_an_arm_is_no_arm(at: At) -> None:
    observer = watching([None, at(1.0, safety=SafetyState.OFF)])
    assert (observer.read(), observer.newest, observer.rest_s) == (None, None, 0.0)
    assert observer.fault(0.0) is FaultKind.FEEDBACK_LOST
    observer.read()
    assert observer.fault(1.0) is FaultKind.ARM_OFF
    assert observer.fault(1.2) is FaultKind.FEEDBACK_LOST  # the newest is stale
