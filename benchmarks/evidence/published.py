"""What was done with each state of the code, published beside the page that is made of it.

FOLDER/NAME.jsonl has every trial and is not part of the repository; of it this keeps what a run must know to go on
elsewhere, and what the page tells: which numbers are done, the counts, every bad trial whole.
"""

import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from scipy.stats import binomtest

from benchmarks.evidence.item import Trial
from service.whole_file import whole_file

RAISED = "raised"  # kind of a trial that did not come to its end; `error` and `place` say what was raised and where
_EARLIER = 3  # states of each item that are told beside today's
_NO_SUM = (0, 0.0)

Sum = tuple[int, float]  # of how many trials


@dataclass(frozen=True)
class State:
    """What was done with one state of the code."""

    code: str
    commits: tuple[str, ...] = ()  # at which the trials were made
    numbers: tuple[tuple[int, int], ...] = ()  # first and last of each run of them; none where nobody kept them
    kinds: dict[str, int] = field(default_factory=dict)  # executions by what each was about
    bad_trials: tuple[Trial, ...] = ()
    first_s: Sum = _NO_SUM  # of the first trial of a part, which pays for what the part begins with
    others_s: Sum = _NO_SUM
    load: Sum = _NO_SUM  # of the machine
    worst: dict[str, float] = field(default_factory=dict)  # the largest of what trials measured, by its name

    @property
    def done(self) -> int:
        """Executions."""
        return sum(self.kinds.values())

    @property
    def bad(self) -> int:
        """Executions that are."""
        return sum(trial["bad"] for trial in self.bad_trials)

    @property
    def raised(self) -> tuple[Trial, ...]:
        """Trials that did not come to their end; they are bad ones."""
        return tuple(trial for trial in self.bad_trials if RAISED in trial.get("kinds", ()))

    @property
    def share_95(self) -> float:
        """At most so many are bad, with 95 % confidence (Clopper and Pearson)."""
        return bounds_95(self.bad, self.done)[1]

    @cached_property
    def known(self) -> frozenset[int]:
        """Numbers that are done."""
        return frozenset(number for first, last in self.numbers for number in range(first, last + 1))

    def with_trials(self, trials: Iterable[Trial]) -> "State":
        """These too, each number once; of a number that was tried twice the bad one."""
        of_number = {trial["number"]: trial for trial in sorted(trials, key=lambda trial: bool(trial["bad"]))}
        new = [trial for number, trial in sorted(of_number.items()) if number not in self.known]
        kinds, worst = Counter(self.kinds), dict(self.worst)
        for trial in new:
            kinds.update(trial["kinds"] if "kinds" in trial else [trial["kind"]])
            worst |= {name: max(value, worst.get(name, value)) for name, value in trial.get("measured", {}).items()}
        return State(
            self.code,
            tuple(dict.fromkeys((*self.commits, *(trial["commit"] for trial in new)))),
            _runs(self.known.union(of_number)),
            dict(sorted(kinds.items())),
            (*self.bad_trials, *(trial for trial in new if trial["bad"])),
            _sum(self.first_s, [trial["seconds"] for trial in new if trial.get("first")]),
            _sum(self.others_s, [trial["seconds"] for trial in new if not trial.get("first")]),
            _sum(self.load, [trial["load"] for trial in new if "load" in trial]),
            worst,
        )


def bounds_95(count: int, of: int) -> tuple[float, float]:
    """Between which a share is with 95 % confidence (Clopper and Pearson)."""
    interval = binomtest(count, of).proportion_ci(0.95, method="exact") if of else None
    return (float(interval.low), float(interval.high)) if interval else (0.0, 1.0)


def gathered(states: Sequence[State], code: str, trials: Iterable[Trial]) -> tuple[State, ...]:
    """Earlier states that are told, the oldest first, and that of today's code, with trials that are kept of it.

    Told are those with the most bad trials, then with the most trials: a short try never takes the place of a long run.
    """
    today = next((state for state in states if state.code == code), State(code))
    earlier = [state for state in states if state.code != code]
    told = sorted(earlier, key=lambda state: (state.bad, state.done))[-_EARLIER:]
    return (
        *(state for state in earlier if state in told),
        today.with_trials(trial for trial in trials if trial["code"] == code),
    )


def read(path: Path) -> dict[str, tuple[State, ...]]:
    """By name of the item, the oldest first."""
    listed = json.loads(path.read_text()) if path.exists() else {}
    return {name: tuple(_state(fields) for fields in states) for name, states in listed.items()}


def write(path: Path, items: Mapping[str, Sequence[State]]) -> None:
    """A line for each state of which anything is done."""
    told = {name: [state for state in states if state.done] for name, states in items.items()}
    parts = (f' "{name}": [\n  ' + ",\n  ".join(map(_line, states)) + "\n ]" for name, states in told.items() if states)
    with whole_file(path) as new:
        new.write_text("{\n" + ",\n".join(parts) + "\n}\n")


def _state(fields: dict[str, Any]) -> State:
    lists = ("commits", "numbers", "bad_trials", "first_s", "others_s", "load")
    return State(**fields | {name: tuple(fields[name]) for name in lists if name in fields})


def _line(state: State) -> str:
    """What is not empty."""
    fields = asdict(state).items()
    return json.dumps({name: value for name, value in fields if value not in ((), {}, _NO_SUM)})


def _runs(numbers: Iterable[int]) -> tuple[tuple[int, int], ...]:
    """First and last of each run of them."""
    runs: list[tuple[int, int]] = []
    for number in sorted(numbers):
        first = runs.pop()[0] if runs and runs[-1][1] == number - 1 else number
        runs.append((first, number))
    return tuple(runs)


def _sum(before: Sum, values: Sequence[float]) -> Sum:
    return before[0] + len(values), round(before[1] + sum(values), 3)
