"""Runs what is missing of the trials, in some processes at a time, and reads what was kept of all runs.

Every trial is a line of FOLDER/NAME.jsonl, with the fingerprint of its code: another state's counts as not done.
"""

import json
import logging
import math
import multiprocessing
import os
import signal
import sys
import time
import traceback
from collections import defaultdict
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import structlog

from benchmarks.evidence.code import commit
from benchmarks.evidence.item import Item, Summary, Trial, summary
from benchmarks.evidence.items import ITEMS
from benchmarks.evidence.timing import Timing, timing
from benchmarks.kept import keep_line, kept_lines
from robot.guard.parent import end_with_parent

Parts = list["Future[None]"]
_RAM_DISK = Path("/dev/shm")  # survives a killed process as a disk does, and power cuts are replayed


@dataclass(frozen=True, slots=True)
class Row:
    """What the kept results of an item amount to."""

    item: Item
    today: Summary
    earlier: tuple[Summary, ...]  # states of the code that have any, the oldest first
    timing: Timing | None  # at the rate of today's code, or of the last that was tried


def row(item: Item, folder: Path) -> Row:
    """By all that is kept in the folder."""
    by_code: defaultdict[str, dict[int, Trial]] = defaultdict(dict)
    for trial in kept_lines(_file(item, folder)):
        by_code[trial["code"]].setdefault(trial["number"], trial)
    of_today = list(by_code.pop(item.code, {}).values())
    states = {code: list(trials.values()) for code, trials in by_code.items()}
    count = item.count(prepared(item, folder))
    today, *earlier = (
        summary(code, trials, count * item.executions) for code, trials in ({item.code: of_today} | states).items()
    )
    last_tried = of_today or next(reversed(states.values()), [])
    return Row(item, today, tuple(earlier), timing(item, last_tried, count))


def prepared(item: Item, folder: Path) -> Path:
    """What the item's trials begin with, made where it is missing."""
    inputs = folder / "inputs" / item.code
    inputs.mkdir(parents=True, exist_ok=True)
    item.prepare(inputs)
    return inputs


@contextmanager
def workers(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Processes for trials; they end with this one, also where it is asked to end."""
    signal.signal(signal.SIGTERM, _end)
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(processes, context, _begin)
    try:
        yield pool
    except BaseException:  # noqa: BLE001  # told, and this process ends
        begun = multiprocessing.active_children()
        for process in begun:
            process.terminate()
        for process in begun:
            process.join()
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)  # the pool's own end may wait for ever on its queue of parts, which nobody reads any more
    pool.shutdown()


def begin(item: Item, folder: Path, share: float, pool: ProcessPoolExecutor) -> Parts:
    """Have what is missing of an item's trials run, behind what was begun before."""
    inputs = prepared(item, folder)
    known = {trial["number"] for trial in kept_lines(_file(item, folder)) if trial["code"] == item.code}
    todo = [number for number in range(math.ceil(item.count(inputs) * share)) if number not in known]
    parts = [todo[first : first + item.at_once] for first in range(0, len(todo), item.at_once)]
    return [pool.submit(_run_part, item.name, folder, inputs, part) for part in parts]


def finish(item: Item, parts: Parts) -> bool:
    """Wait for them; False where they could not all be run."""
    started_s, whole = time.monotonic(), True
    for done, part in enumerate(as_completed(parts), 1):
        whole &= _told(part)
        left_min = (time.monotonic() - started_s) / done * (len(parts) - done) / 60.0
        print(f"\r{item.name}: {done} of {len(parts)} parts, {left_min:.0f} min left ", end="", file=sys.stderr)
    return whole


def _told(future: "Future[None]") -> bool:
    """Whether a part ran to its end; a harness that failed is no result, and the other parts go on."""
    error = future.exception()
    if isinstance(error, BrokenProcessPool):
        raise error
    if error is not None:
        print("", *traceback.format_exception(error), sep="\n", file=sys.stderr)
    return error is None


def _begin() -> None:
    """A process for trials: quiet, its files in memory, ended with its parent, whatever ended that."""
    signal.signal(signal.SIGTERM, _end)
    end_with_parent()
    structlog.configure(wrapper_class=structlog.make_filtering_bound_logger(logging.CRITICAL))
    logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)  # a refused hold is one to it
    if _RAM_DISK.is_dir():
        os.environ["TMPDIR"] = str(_RAM_DISK)


def _end(*_: Any) -> None:
    """Out of everything, so that nothing is left running or lying about."""
    sys.exit(f"ended by {signal.SIGTERM.name}")


def _run_part(name: str, folder: Path, inputs: Path, numbers: Sequence[int]) -> None:
    """Some trials, unless this process is asked to end."""
    try:
        _run_trials(name, folder, inputs, numbers)
    except (SystemExit, KeyboardInterrupt):  # all is cleared away; the pool would take it for a part that failed
        os._exit(1)


def _run_trials(name: str, folder: Path, inputs: Path, numbers: Sequence[int]) -> None:
    """Each kept as soon as it is done."""
    item = next(item for item in ITEMS if item.name == name)
    at, before_s = commit(), _spent_s(item)
    for place, trial in enumerate(item.trials(inputs, numbers)):
        now_s = _spent_s(item)
        timed = {"seconds": round(now_s - before_s, 5), "first": place == 0, "load": os.getloadavg()[0]}
        before_s = now_s
        keep_line(_file(item, folder), trial | timed | {"code": item.code, "commit": at})
        if trial["bad"]:
            print(f"\nbad: {name}: {json.dumps(trial)}", file=sys.stderr)


def _spent_s(item: Item) -> float:
    """Of the processor by this process and those that it waited for; of the clock where trials wait."""
    spent = os.times()
    return time.monotonic() if item.waits else sum(spent[:4])


def _file(item: Item, folder: Path) -> Path:
    return folder / f"{item.name}.jsonl"
