"""One row of the evidence: what is tried how often, what came of it, and what that proves."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scipy.stats import binomtest

Trial = dict[str, Any]  # `number`, `bad`, and what it was about: its `kind`, or how many executions of which `kinds`
Trials = Callable[[Path, Sequence[int]], Iterator[Trial]]


@dataclass(frozen=True)
class Item:
    """What is tried, by number; `trials` yields one result for each number that it is given."""

    name: str
    what: str
    asked: str
    count: Callable[[Path], int]  # trials for the whole proof; may depend on what is prepared in the folder
    trials: Trials
    at_once: int  # numbers given at a time
    executions: int = 1  # of one trial


@dataclass(frozen=True)
class Summary:
    """What the trials amount to."""

    done: int
    planned: int
    bad: int
    share_95: float  # at most so many are bad, with 95 % confidence (Clopper and Pearson)
    kinds: dict[str, int]

    @property
    def holds(self) -> bool:
        """All done, and none bad."""
        return self.bad == 0 and self.done >= self.planned


def summary(trials: Sequence[Trial], planned: int) -> Summary:
    """Counts of executions by what each was about."""
    bad = sum(trial["bad"] for trial in trials)
    kinds: Counter[str] = Counter()
    for trial in trials:
        kinds.update(trial["kinds"] if "kinds" in trial else [trial["kind"]])
    done = kinds.total()
    share = float(binomtest(bad, done).proportion_ci(0.95, method="exact").high) if done else 1.0
    return Summary(done, planned, bad, share, dict(kinds))
