"""The control chart of one series: a self-starting CUSUM of sequential ranks, the same for every kind of spread.

What a case measures is skewed and nobody knows its distribution, and a device that drifts from its first case on never
shows a baseline. So each value is replaced by its rank among those up to it: without a drift these ranks are
independent and their distributions known, whatever the values' own is (Barndorff-Nielsen, 1963), and a CUSUM of them
needs neither baseline nor parameters (McDonald, Naval Research Logistics 37, 1990).
"""

import math
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

Array = NDArray[np.float64]

FEWEST_CASES = 8  # below it even values that rise case by case are no evidence against chance: 1 in 8! orders
WINDOW_CASES = 100  # newest cases of a chart; also the span over which the chance of a false signal is held
_REFERENCE = 0.5  # k, in standard deviations: half of the shift of one that it is quickest for (Montgomery, ch. 9.1)
_HEAD_START = 0.5  # of the limit: a fast initial response, for what drifts from the first case on (Lucas, Crosier 1982)
_STEP = 0.02  # of the grid on which the limit is computed, in standard deviations
_HALVINGS = 12
_GREATEST_LIMIT = 60.0


class Way(StrEnum):
    """What a chart looks out for."""

    RISING = "rising"
    FALLING = "falling"


@dataclass(frozen=True, slots=True, eq=False)
class Signal:
    """Where a chart crossed its limit: indices of cases.

    `since` is the first case of the run that led there, `per_case` the slope of the values over it (Theil, Sen).
    """

    at: int
    since: int
    per_case: float


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """The cumulative sums of a series, their limit, and the first signal where there is one."""

    way: Way
    sums: Array
    limit: float
    signal: Signal | None


def rank_scores(values: Array) -> Array:
    """Normal scores of the sequential ranks.

    Parameters
    ----------
    values : (n,) array
        In the order of the cases.

    Returns
    -------
    (n,) array
        Phi^-1((r - 1/2) / i) of each value's rank r among the first i values; equal ones share the mean of their ranks.
    """
    counts = np.arange(1, len(values) + 1)
    earlier = np.tril(np.ones((len(values), len(values)), dtype=bool))
    below = np.sum(earlier & (values[None, :] < values[:, None]), axis=1)
    equal = np.sum(earlier & (values[None, :] == values[:, None]), axis=1)
    return np.asarray(ndtri((below + equal / 2.0) / counts))


def drift_chart(values: Array, way: Way, false_signals: float) -> Chart:
    """The chart of one way in which values may drift.

    Parameters
    ----------
    values : (n,) array
        In the order of the cases, n at most WINDOW_CASES.
    way : Way
        A chart for values that rise, or for those that fall.
    false_signals : float
        The chance of a signal within WINDOW_CASES cases without a drift.

    Notes
    -----
    C_i = max(0, C_(i-1) + z_i - k), a signal where C_i > h (Montgomery, Introduction to Statistical Quality Control,
    eq. 9.2), with the scores of `rank_scores` for z and C_1 = h / 2.
    """
    limit = decision_limit(false_signals)
    sums = np.empty(len(values))
    height = _HEAD_START * limit
    for number, score in enumerate(rank_scores(values if way is Way.RISING else -values)):
        height = max(0.0, height + score - _REFERENCE) if number else height
        sums[number] = height
    return Chart(way, sums, limit, _signal(values, sums, limit))


def _signal(values: Array, sums: Array, limit: float) -> Signal | None:
    crossed = np.flatnonzero(sums > limit)
    if not len(crossed):
        return None
    # Imported here: it costs every start of the service half a second.
    from scipy.stats import theilslopes

    at = int(crossed[0])
    zeros = np.flatnonzero(sums[:at] == 0.0)
    since = int(zeros[-1]) + 1 if len(zeros) else 0
    first = min(since, at - 1)  # a slope needs two
    return Signal(at, since, float(theilslopes(values[first : at + 1]).slope))


@lru_cache(maxsize=64)
def decision_limit(false_signals: float) -> float:
    """The limit h that the sums of WINDOW_CASES cases cross with this chance where nothing drifts.

    The chance is computed over the sums' distribution, case by case on a grid (Brook, Evans 1972).
    """
    low, high = 1.0, _GREATEST_LIMIT
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        low, high = (middle, high) if _chance_to_cross(middle) > false_signals else (low, middle)
    return high


def _chance_to_cross(limit: float) -> float:
    """That the sums cross the limit: all but what is still below it after the last case."""
    chances = np.zeros(math.ceil(limit / _STEP))
    chances[int(_HEAD_START * limit / _STEP)] = 1.0
    for steps in _score_steps():
        after = np.zeros_like(chances)
        for step in steps:
            if step >= 0:
                after[step:] += chances[: max(len(chances) - step, 0)]
            else:
                after[0] += chances[:-step].sum()
                after[:step] += chances[-step:]
        chances = after / len(steps)
    return 1.0 - float(chances.sum())


@lru_cache(maxsize=1)
def _score_steps() -> tuple[tuple[int, ...], ...]:
    """For each case behind the first, how far each of its equally likely ranks moves the sum, in steps of the grid."""
    steps = []
    for count in range(2, WINDOW_CASES + 1):
        scores = ndtri((np.arange(1, count + 1) - 0.5) / count)
        steps.append(tuple(int(step) for step in np.rint((scores - _REFERENCE) / _STEP)))
    return tuple(steps)
