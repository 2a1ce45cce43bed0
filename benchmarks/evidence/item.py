"""One row of the evidence: what is tried, and how often."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

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
