"""What is tried by number: a reader of something from outside, valid inputs, and what may become of hostile ones."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from random import Random

from benchmarks.fuzz.mutation import Change, mutated

Outcome = str  # "taken", or the code or kind of a refusal


@dataclass(frozen=True)
class Input:
    """A valid input, what is done to it, and who reads it; whatever `read` raises is a finding."""

    content: bytes
    changes: Sequence[Change]
    read: Callable[[bytes], Outcome]
    mend: Callable[[bytes], bytes] | None = None  # of checksums, in every other execution


@dataclass
class Tried:
    """Outcomes by kind, and what was found: the number of the execution and what it raised."""

    kinds: Counter[Outcome] = field(default_factory=Counter)
    found: list[tuple[int, str]] = field(default_factory=list)


def hostile(inputs: Sequence[Input], number: int) -> tuple[Input, bytes]:
    """The input that a number stands for."""
    random = Random(number)
    chosen = random.choice(inputs)
    data = mutated(chosen.content, chosen.changes, random)
    return chosen, chosen.mend(data) if chosen.mend is not None and random.random() < 0.5 else data


def tried(inputs: Sequence[Input], numbers: Iterable[int], begins: Callable[[int], None] = lambda _: None) -> Tried:
    """What becomes of each number; `begins` is told before the reader has it."""
    result = Tried()
    for number in numbers:
        chosen, data = hostile(inputs, number)
        begins(number)
        try:
            result.kinds[chosen.read(data)] += 1
        except Exception as error:  # noqa: BLE001  whatever a reader raises is what is looked for
            result.kinds["untyped"] += 1
            result.found.append((number, f"{type(error).__name__}: {error}"[:200]))
    return result
