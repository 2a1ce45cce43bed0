"""How long all of a row takes, from the trials of it that were done."""

import math
from dataclasses import dataclass

from benchmarks.evidence.item import Item
from benchmarks.evidence.published import State, Sum

_PROCESSES = 2  # that the budget is reckoned with


@dataclass(frozen=True, slots=True)
class Timing:
    """Of a whole row."""

    hours: float  # on two cores
    load: float | None  # of the machine while trials were timed that wait; None of others, or where nobody looked


def timing(item: Item, state: State, planned: int) -> Timing | None:
    """At the rate of these trials; the first of a part pays for what the part begins with, and is reckoned apart."""
    if not (state.first_s[0] or state.others_s[0]):
        return None
    parts = math.ceil(planned / item.at_once)
    of_first_s = _mean(state.first_s if state.first_s[0] else state.others_s)
    of_others_s = _mean(state.others_s if state.others_s[0] else state.first_s)
    seconds = parts * of_first_s + (planned - parts) * of_others_s
    return Timing(seconds / _PROCESSES / 3600.0, _mean(state.load) if item.waits and state.load[0] else None)


def _mean(values: Sum) -> float:
    count, whole = values
    return whole / count
