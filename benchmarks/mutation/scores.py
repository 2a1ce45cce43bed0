"""What the trials amount to, and which changes no test could notice."""

import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.mutation.forks import Status
from benchmarks.mutation.mutants import Mutant

_EQUIVALENT = Path(__file__).with_name("equivalent.toml")
_FOUND = (Status.KILLED, Status.ENDLESS)


@dataclass(frozen=True, slots=True)
class Score:
    """Of one package; what Python refuses to load and what means the same counts neither way."""

    tried: int
    left: int  # not tried yet
    found: int
    equivalent: int
    stillborn: int
    missed: tuple[Mutant, ...]

    @property
    def share_of_tried(self) -> float:
        """Of the mutants that were tried and mean something else, those that a test finds."""
        return self.found / max(1, self.found + len(self.missed))

    @property
    def share(self) -> float:
        """The same of all; what was not tried counts as missed."""
        return self.found / max(1, self.found + len(self.missed) + self.left)


def reasons() -> dict[str, str]:
    """By mutant: why it means the same as what it changes."""
    listed = tomllib.loads(_EQUIVALENT.read_text())["same"]
    return {key: entry["reason"] for entry in listed for key in entry["changes"]}


def score(mutants: Sequence[Mutant], statuses: Mapping[str, Status]) -> Score:
    """Of one package's mutants, those that were tried."""
    tried = [mutant for mutant in mutants if mutant.key in statuses]
    same = reasons()
    counts = Counter(statuses[mutant.key] for mutant in tried)
    unseen = [mutant for mutant in tried if statuses[mutant.key] in (Status.SURVIVED, Status.UNREACHED)]
    missed = tuple(mutant for mutant in unseen if mutant.key not in same)
    return Score(
        tried=len(tried),
        left=len(mutants) - len(tried),
        found=sum(counts[status] for status in _FOUND),
        equivalent=len(unseen) - len(missed),
        stillborn=counts[Status.STILLBORN],
        missed=missed,
    )
