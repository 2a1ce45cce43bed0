"""Cycles keep to the clock: delays are caught up, and only a long standstill is given up."""

import pytest

from simulator.controller.pacing import Pacing

pytestmark = pytest.mark.real_time


class Clock:
    def __init__(self):
        self.now_s = 100.0

    def __call__(self):
        return self.now_s


def run(pacing, clock, until_s):
    """Cycles done until a time, waiting for each as the loop does."""
    done = 0
    while clock.now_s + max(0.0, pacing.wait_s()) <= until_s:
        clock.now_s += max(0.0, pacing.wait_s())
        pacing.note()
        done += 1
    return done


def test_cycles_follow_the_clock_without_drift():
    clock = Clock()
    pacing = Pacing(0.008, clock)
    assert run(pacing, clock, 100.0 + 80.0 + 1e-6) == 10_000
    assert pacing.worst_delay_s == pytest.approx(0.0, abs=1e-9)


def test_delay_is_caught_up():
    clock = Clock()
    pacing = Pacing(0.008, clock)
    run(pacing, clock, 101.0)
    clock.now_s += 0.15
    assert run(pacing, clock, 102.0) == 125
    assert pacing.worst_delay_s == pytest.approx(0.15, abs=0.008)
    assert pacing.stalled_s == 0.0


def test_long_standstill_is_given_up_and_counted():
    clock = Clock()
    pacing = Pacing(0.008, clock)
    run(pacing, clock, 101.0)
    clock.now_s += 5.0
    assert run(pacing, clock, 107.0) == pytest.approx(125, abs=2)
    assert pacing.stalled_s == pytest.approx(5.0, abs=0.01)
