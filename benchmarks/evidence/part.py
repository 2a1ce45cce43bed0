"""One part of an item's trials: each kept as soon as it is done, and one that raises is a bad trial itself.

Unless nothing can be tried at all, without a server of PostgreSQL for example: before anything that was raised is kept,
another trial must have been done since.
"""

import json
import os
import sys
import time
import traceback
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from benchmarks.evidence.code import ROOT, commit
from benchmarks.evidence.item import Item, Trial
from benchmarks.evidence.published import RAISED
from benchmarks.evidence.raised import TrialError
from benchmarks.kept import keep_line

_MOST_HELD = 3  # trials that raised one behind the other, until one that was done is tried again


def run_trials(item: Item, file: Path, inputs: Path, numbers: Sequence[int]) -> None:
    """Keep a trial of each number; raises what a trial raised where none can be done."""
    part, left, on = _Part(item, file, inputs), dict.fromkeys(numbers), True
    while left and on:
        on = False
        for place, one in enumerate(_until_raised(item, inputs, tuple(left))):
            if isinstance(one, Exception):
                on, number = True, _number(one, left)
                part.raised(number, one, first=place == 0)
            else:
                number = one["number"]
                part.done(one, first=place == 0)
            del left[number]
    part.settle()


def _until_raised(item: Item, inputs: Path, numbers: Sequence[int]) -> Iterator[Trial | Exception]:
    """What is done, at last what was raised."""
    try:
        yield from item.trials(inputs, numbers)
    except Exception as error:  # noqa: BLE001  # whatever a trial raises is its result
        yield error


def _number(error: Exception, left: Iterable[int]) -> int:
    """Whose trial raised: of those that come in their order, the next one's."""
    if isinstance(error, TrialError):
        return error.number
    for number in left:
        return number
    raise error  # behind the last trial, in clearing away


class _Part:
    """Keeps trials, what raised not before it is known that it was the trial's doing."""

    def __init__(self, item: Item, file: Path, inputs: Path) -> None:
        self._item, self._file, self._inputs = item, file, inputs
        self._common = {"code": item.code, "commit": commit()}
        self._before_s = _spent_s(item)
        self._held: list[Trial] = []
        self._error: Exception | None = None

    def done(self, trial: Trial, *, first: bool) -> None:
        """Keep it, and what was held."""
        self._keep_held()
        self._keep(self._timed(trial, first=first))

    def raised(self, number: int, error: Exception, *, first: bool) -> None:
        """Hold it until something is done again."""
        traceback.print_exception(error, file=sys.stderr)
        self._held.append(self._timed(_raised(self._item, number, error), first=first))
        self._error = error
        if len(self._held) >= _MOST_HELD:
            self.settle()

    def settle(self) -> None:
        """Keep what is held if a trial that was done before can be done again; else raise as the last one did."""
        if not self._held or self._error is None:
            return
        known = _done(self._file, self._item.code)
        if known is None:
            raise self._error
        list(self._item.trials(self._inputs, (known,)))
        self._before_s = _spent_s(self._item)
        self._keep_held()

    def _keep_held(self) -> None:
        for trial in self._held:
            self._keep(trial)
        self._held.clear()

    def _timed(self, trial: Trial, *, first: bool) -> Trial:
        now_s = _spent_s(self._item)
        timed = {"seconds": round(now_s - self._before_s, 5), "first": first, "load": os.getloadavg()[0]}
        self._before_s = now_s
        return trial | timed

    def _keep(self, trial: Trial) -> None:
        keep_line(self._file, trial | self._common)
        if trial["bad"]:
            print(f"\nbad: {self._item.name}: {json.dumps(trial)}", file=sys.stderr)


def _raised(item: Item, number: int, error: Exception) -> Trial:
    """All its executions are bad. Only what was raised and where: its words may be those of an image's header."""
    cause = error.__cause__ if isinstance(error, TrialError) and error.__cause__ is not None else error
    kind = type(cause)
    said = {"error": f"{kind.__module__}.{kind.__qualname__}", "place": _place(cause)}
    return {"number": number, "kinds": {RAISED: item.executions}, "bad": item.executions} | said


def _place(error: BaseException) -> str:
    """The innermost line of the project's that it went through."""
    frames = ((Path(frame.filename), frame) for frame in traceback.extract_tb(error.__traceback__))
    ours = [(file.relative_to(ROOT), frame) for file, frame in frames if _is_ours(file)]
    file, frame = ours[-1]
    return f"{file}:{frame.lineno} in {frame.name}"


def _is_ours(file: Path) -> bool:
    return file.is_relative_to(ROOT) and not file.relative_to(ROOT).parts[0].startswith(".")  # as .venv does


def _done(file: Path, code: str) -> int | None:
    """A number whose trial was done to its end, by whichever process."""
    lines: Iterable[str] = file.read_text().splitlines(keepends=True) if file.exists() else ()
    trials = (json.loads(line) for line in lines if line.endswith("\n"))
    numbers = (int(trial["number"]) for trial in trials if trial["code"] == code and not trial["bad"])
    return next(numbers, None)


def _spent_s(item: Item) -> float:
    """Of the processor by this process and those that it waited for; of the clock where trials wait."""
    spent = os.times()
    return time.monotonic() if item.waits else sum(spent[:4])
