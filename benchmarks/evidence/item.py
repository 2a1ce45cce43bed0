"""One row of the evidence: what is tried how often, what came of it, and what that proves."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from scipy.stats import binomtest

from benchmarks.evidence.code import fingerprint

Trial = dict[str, Any]  # `number`, `bad`, and what it was about: its `kind`, or how many executions of which `kinds`
Trials = Callable[[Path, Sequence[int]], Iterator[Trial]]


def _nothing(_inputs: Path) -> None:
    """Most trials begin with nothing."""


@dataclass(frozen=True)
class Item:
    """What is tried, by number; `trials` yields one result for each number that it is given.

    Both it and `count` are given a folder in which `prepare` has made what the trials begin with.
    """

    name: str
    what: str
    asked: str
    count: Callable[[Path], int]  # trials for the whole proof
    trials: Trials
    at_once: int  # numbers given at a time
    modules: tuple[str, ...]  # whose code the trials run, with all that they import
    files: tuple[str, ...] = ()  # patterns of other files that it reads
    executions: int = 1  # of one trial
    prepare: Callable[[Path], None] = _nothing
    waits: bool = False  # on clocks and other processes: its time is the clock's, not the processor's

    @cached_property
    def code(self) -> str:
        """Fingerprint of what the trials run, as it is now: a result of any other code proves nothing of this one."""
        return fingerprint(self.modules, self.files)


@dataclass(frozen=True)
class Summary:
    """What the trials of one state of the code amount to."""

    code: str
    commits: tuple[str, ...]  # at which they were made
    done: int
    planned: int
    bad: int
    share_95: float  # at most so many are bad, with 95 % confidence (Clopper and Pearson)
    kinds: dict[str, int]
    seconds: float | None  # one execution took, where that is known

    @property
    def holds(self) -> bool:
        """All done, and none bad."""
        return self.bad == 0 and self.done >= self.planned


def summary(code: str, trials: Sequence[Trial], planned: int) -> Summary:
    """Counts of executions by what each was about."""
    bad = sum(trial["bad"] for trial in trials)
    kinds: Counter[str] = Counter()
    for trial in trials:
        kinds.update(trial["kinds"] if "kinds" in trial else [trial["kind"]])
    done = kinds.total()
    share = float(binomtest(bad, done).proportion_ci(0.95, method="exact").high) if done else 1.0
    seconds = sum(trial["seconds"] for trial in trials) / done if done else None
    commits = tuple(dict.fromkeys(trial["commit"] for trial in trials))
    return Summary(code, commits, done, planned, bad, share, dict(kinds), seconds)
