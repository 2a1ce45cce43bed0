"""Trapezoidal ramps: arrive exactly, never faster and never harder than allowed, whatever interrupts them."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.controller.ramps import Ramp

CYCLE_S = 0.008
ROUNDING = 1e-6
lengths = st.floats(0.001, 100.0)
speeds = st.floats(2.0, 250.0)
accelerations = st.floats(5.0, 2000.0)


def advance(ramp, cycles, scaling=1.0):
    """Positions and speeds after each cycle, the present ones first."""
    track = [(ramp.position, ramp.speed)]
    for _ in range(cycles):
        ramp.advance(CYCLE_S, scaling)
        track.append((ramp.position, ramp.speed))
    return track


def hardest(track):
    return max(abs(after - before) / CYCLE_S for (_, before), (_, after) in pairwise(track))


@given(lengths, speeds, accelerations)
def test_ramp_arrives_within_its_speed_and_acceleration(length, cruise, acceleration):
    ramp = Ramp(length, cruise, acceleration)
    expected_s = length / cruise + cruise / acceleration  # long enough for a triangle too
    track = advance(ramp, int(expected_s / CYCLE_S) + 3)
    assert ramp.arrived
    assert (ramp.position, ramp.speed) == (length, 0.0)
    assert max(speed for _, speed in track) <= cruise + ROUNDING
    assert hardest(track) <= acceleration * (1.0 + ROUNDING)


def test_long_ramp_takes_the_time_of_a_trapezoid():
    ramp = Ramp(100.0, 20.0, 100.0)
    advance(ramp, round(5.2 / CYCLE_S) - 1)
    assert not ramp.arrived
    advance(ramp, 1)
    assert ramp.arrived


@given(accelerations, accelerations)
def test_brake_ends_the_motion_in_the_braking_distance(acceleration, deceleration):
    ramp = Ramp(1000.0, 20.0, acceleration)
    while ramp.speed < 20.0 - ROUNDING:
        ramp.advance(CYCLE_S)
    from_mm = ramp.position
    ramp.brake(deceleration)
    track = advance(ramp, int(20.0 / deceleration / CYCLE_S) + 2)
    assert ramp.at_rest
    assert hardest(track) <= deceleration * (1.0 + ROUNDING)
    assert ramp.position - from_mm == pytest.approx(20.0**2 / (2 * deceleration), abs=20.0 * CYCLE_S)
    ramp.release()
    assert advance(ramp, 10)[-1][0] == ramp.position


def test_hold_goes_on_after_release_and_arrives():
    ramp = Ramp(50.0, 20.0, 100.0)
    advance(ramp, 50)
    ramp.hold(0.1)
    advance(ramp, 14)
    held_at = ramp.position
    assert ramp.at_rest
    assert advance(ramp, 100)[-1] == (held_at, 0.0)
    ramp.release()
    advance(ramp, 400)
    assert ramp.arrived


def test_brake_during_a_hold_forbids_going_on():
    ramp = Ramp(50.0, 20.0, 100.0)
    advance(ramp, 50)
    ramp.hold(0.1)
    ramp.brake(100.0)
    ramp.release()
    advance(ramp, 400)
    assert ramp.at_rest
    assert not ramp.arrived


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8))
def test_changed_speed_scaling_never_exceeds_the_acceleration(scalings):
    ramp = Ramp(200.0, 20.0, 100.0)
    track = [point for scaling in scalings for point in advance(ramp, 40, scaling)[1:]]
    assert hardest(track) <= 100.0 * (1.0 + ROUNDING)
    assert max(speed for _, speed in track) <= 20.0 + ROUNDING


def test_fresh_ramp_is_not_at_rest():
    assert not Ramp(1.0, 20.0, 100.0).at_rest
