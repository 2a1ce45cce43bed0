"""How long all of a row takes, from the trials of it that are kept."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from benchmarks.evidence.item import Item, Trial

_PROCESSES = 2  # that the budget is reckoned with


@dataclass(frozen=True, slots=True)
class Timing:
    """Of a whole row."""

    hours: float  # on two cores
    load: float | None  # of the machine while trials were timed that wait; None of others, or where nobody looked


def timing(item: Item, trials: Sequence[Trial], planned: int) -> Timing | None:
    """At the rate of these trials; the first of a part pays for what the part begins with, and is reckoned apart."""
    if not trials:
        return None
    parts = math.ceil(planned / item.at_once)
    first = [trial["seconds"] for trial in trials if trial.get("first")]
    others = [trial["seconds"] for trial in trials if not trial.get("first")]
    seconds = parts * fmean(first or others) + (planned - parts) * fmean(others or first)
    loads = [trial["load"] for trial in trials if "load" in trial]
    return Timing(seconds / _PROCESSES / 3600.0, fmean(loads) if item.waits and loads else None)
