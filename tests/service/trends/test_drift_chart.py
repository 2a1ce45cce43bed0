"""The chart of one series: no false signals whatever the spread, a drift soon, and the limit as the textbook has it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binomtest

from benchmarks.trends import Room, errors_mm, is_false, is_seen
from service.trends.chart import WINDOW_CASES, Way, decision_limit, drift_chart, rank_scores

_MANY = 800


def test_the_scores_are_those_of_the_ranks_among_the_cases_so_far() -> None:
    scores = rank_scores(np.array([5.0, 7.0, 1.0, 6.0]))
    assert scores == pytest.approx([0.0, 0.6745, -0.9674, 0.3186], abs=1e-4)  # ranks 1, 2, 1, 3 of 1, 2, 3, 4


@given(st.lists(st.floats(0.01, 10.0), min_size=2, max_size=30))
def test_a_chart_knows_only_the_order_of_its_values(values: list[float]) -> None:
    plain = np.array(values)
    sums = drift_chart(plain, Way.RISING, 0.01).sums
    assert np.array_equal(sums, drift_chart(2.0 * plain, Way.RISING, 0.01).sums)
    assert np.array_equal(sums, drift_chart(-plain, Way.FALLING, 0.01).sums)


def test_equal_values_never_signal() -> None:
    assert drift_chart(np.full(WINDOW_CASES, 2.0), Way.RISING, 0.01).signal is None


def test_the_limit_is_crossed_as_seldom_as_it_promises() -> None:
    false_signals = 0.02
    rng = np.random.default_rng(5)
    crossed = sum(
        drift_chart(rng.lognormal(0.0, 1.0, WINDOW_CASES), Way.RISING, false_signals).signal is not None
        for _ in range(_MANY)
    )
    assert binomtest(crossed, _MANY, false_signals).pvalue > 1e-4


def test_the_limit_rises_where_fewer_false_signals_are_allowed() -> None:
    assert decision_limit(0.05) < decision_limit(0.01) < decision_limit(0.001)


def test_a_signal_says_where_the_run_began_and_how_steep_it_is() -> None:
    rng = np.random.default_rng(3)
    values = 1.0 + 0.05 * rng.standard_normal(60) + 0.1 * np.maximum(0, np.arange(60) - 40)
    signal = drift_chart(values, Way.RISING, 0.001).signal
    assert signal is not None
    assert 40 < signal.at < 60
    assert 36 <= signal.since <= 44
    assert signal.per_case == pytest.approx(0.1, rel=0.2)
    falling = drift_chart(-values, Way.FALLING, 0.001).signal
    assert falling is not None
    assert falling.per_case == pytest.approx(-signal.per_case)


@pytest.mark.parametrize(("clean", "median_mm"), [(0, 0.02), (20, 0.05)])
def test_a_drift_of_two_hundredths_a_case_is_flagged_within_twenty_cases(clean: int, median_mm: float) -> None:
    rng = np.random.default_rng(7)
    reports = 40
    seen = sum(is_seen(Room(median_mm), clean, 0.02, rng) for _ in range(reports))
    assert binomtest(seen, reports, 0.97, alternative="less").pvalue > 1e-4  # make trends-bench has the figures


def test_a_report_where_nothing_drifts_flags_nothing() -> None:
    rng = np.random.default_rng(9)
    reports = 40
    false = sum(is_false(Room(0.05, skew=1.0), 40, rng) for _ in range(reports))
    assert binomtest(false, reports, 0.01, alternative="greater").pvalue > 1e-4


def test_the_planted_errors_have_the_median_that_they_are_asked_for() -> None:
    planted = errors_mm(Room(0.04), np.zeros(4000), np.random.default_rng(1))
    assert np.median(planted) == pytest.approx(0.04, rel=0.06)
    assert planted.mean() > 1.15 * np.median(planted)  # skewed
