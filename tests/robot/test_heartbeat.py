"""Heartbeats as pure logic: numbers, challenges, and a clock that is passed in."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot.guard.heartbeat import SILENCE_S, HeartbeatMonitor
from robot.guard.messages import Heartbeat


def beat(number: int, challenge: str, held: bool = True, permit: str = "p") -> Heartbeat:
    return Heartbeat(permit, number, challenge, held)


def test_nobody_holds_before_the_first_heartbeat() -> None:
    monitor = HeartbeatMonitor()
    monitor.issue(0.0)
    assert not monitor.held
    assert not monitor.is_live("p", 0.0)
    assert monitor.age_s(0.0) is None


def test_each_permit_counts_and_holds_for_itself() -> None:
    monitor = HeartbeatMonitor()
    monitor.receive(beat(50, monitor.issue(0.0), permit="old"))
    monitor.receive(beat(51, monitor.issue(0.1), held=False, permit="old"))
    assert not monitor.receive(beat(0, "unknown", permit="new"))
    assert (monitor.permit_id, monitor.held, monitor.age_s(0.2)) == ("new", False, None)
    assert monitor.receive(beat(0, monitor.issue(0.2), permit="new"))  # lower than the old one's, and not let go of
    assert monitor.is_live("new", 0.2)
    assert monitor.receive(beat(9, monitor.issue(0.3), permit="old")) is False


def test_a_hold_does_not_carry_over_to_the_next_permit() -> None:
    monitor = HeartbeatMonitor()
    monitor.receive(beat(1, monitor.issue(0.0), permit="old"))
    assert monitor.held
    monitor.receive(beat(1, "unknown", permit="new"))
    assert not monitor.held


def test_a_challenge_that_was_overtaken_makes_no_hold_older() -> None:
    monitor = HeartbeatMonitor()
    early, late = monitor.issue(1.0), monitor.issue(2.0)
    monitor.receive(beat(1, late))
    monitor.receive(beat(2, early))
    assert monitor.age_s(2.5) == 0.5


def test_hold_is_live_up_to_the_limit_and_silent_beyond_it() -> None:
    monitor = HeartbeatMonitor()
    assert monitor.receive(beat(1, monitor.issue(10.0)))
    assert monitor.is_live("p", 10.0 + SILENCE_S)
    assert not monitor.is_live("p", 10.0 + SILENCE_S + 1e-6)


def test_hold_is_live_at_the_limit_itself() -> None:
    monitor = HeartbeatMonitor()
    monitor.receive(beat(1, monitor.issue(0.0)))
    assert monitor.is_live("p", SILENCE_S)


@pytest.mark.hazard("H36")
@given(delay_s=st.floats(0.0, 3.0), period_s=st.floats(0.01, 0.1), count=st.integers(5, 40))
def test_steady_traffic_that_is_late_counts_for_as_old_as_it_is(delay_s: float, period_s: float, count: int) -> None:
    monitor = HeartbeatMonitor()
    challenges = [(monitor.issue(index * period_s), index * period_s) for index in range(count)]
    for number, (challenge, issued_at_s) in enumerate(challenges):
        monitor.receive(beat(number, challenge))
        now_s = issued_at_s + delay_s
        assert monitor.is_live("p", now_s) == (now_s - issued_at_s <= SILENCE_S)


@given(order=st.permutations(range(8)))
def test_a_number_that_is_not_the_newest_is_no_sign_of_life(order: list[int]) -> None:
    monitor = HeartbeatMonitor()
    challenges = [monitor.issue(float(index)) for index in range(8)]
    newest = -1
    for number in order:
        assert monitor.receive(beat(number, challenges[number])) == (number > newest)
        newest = max(newest, number)


@pytest.mark.hazard("H36")
def test_repeated_heartbeats_do_not_prolong_a_hold() -> None:
    monitor = HeartbeatMonitor()
    challenge = monitor.issue(0.0)
    assert monitor.receive(beat(1, challenge))
    assert not monitor.receive(beat(1, challenge))
    for number in range(2, 50):
        monitor.receive(beat(number, challenge))  # a sender that goes on with the challenge it last saw
    assert not monitor.is_live("p", 0.3)


def test_challenge_of_another_guard_is_no_sign_of_life() -> None:
    monitor, other = HeartbeatMonitor(), HeartbeatMonitor()
    monitor.issue(0.0)
    assert not monitor.receive(beat(1, other.issue(0.0)))
    assert not monitor.is_live("p", 0.0)


def test_letting_go_counts_whatever_its_number_and_challenge_and_is_final() -> None:
    monitor = HeartbeatMonitor()
    monitor.receive(beat(5, monitor.issue(0.0)))
    monitor.receive(beat(2, "unknown", held=False))
    assert not monitor.held
    assert not monitor.receive(beat(6, monitor.issue(0.01)))
    assert not monitor.is_live("p", 0.01)


def test_late_heartbeats_of_an_earlier_permit_are_not_heard() -> None:
    monitor = HeartbeatMonitor()
    monitor.receive(beat(1, monitor.issue(0.0), permit="old"))
    monitor.receive(beat(1, monitor.issue(0.1), permit="new"))
    assert not monitor.receive(beat(2, monitor.issue(0.2), permit="old"))
    assert monitor.permit_id == "new"
    assert not monitor.is_live("old", 0.2)


def test_challenges_are_all_different() -> None:
    monitor = HeartbeatMonitor()
    assert len({monitor.issue(0.0) for _ in range(1000)}) == 1000


@pytest.mark.parametrize(("since", "remembered"), [(511, True), (512, False)])
def test_a_challenge_is_remembered_for_as_long_as_it_may_count_and_then_forgotten(since: int, remembered: bool) -> None:
    monitor = HeartbeatMonitor()
    old = monitor.issue(0.0)
    for _ in range(since):
        monitor.issue(1.0)
    assert monitor.receive(beat(1, old)) is remembered
