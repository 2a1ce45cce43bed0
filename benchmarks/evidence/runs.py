"""Runs what is missing of the trials, in some processes at a time, and publishes what was done.

Every trial is a line of FOLDER/NAME.jsonl, with the fingerprint of its code: another state's counts as not done.
"""

import logging
import multiprocessing
import os
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import structlog

from benchmarks.evidence.item import Item
from benchmarks.evidence.part import run_trials
from benchmarks.evidence.published import State, gathered, read, write
from benchmarks.evidence.timing import Timing, timing
from benchmarks.kept import kept_lines
from robot.guard.parent import end_with_parent

Parts = list["Future[None]"]
_RAM_DISK = Path("/dev/shm")  # survives a killed process as a disk does, and power cuts are replayed


@dataclass(frozen=True, slots=True)
class Row:
    """What the results of an item amount to."""

    item: Item
    planned: int  # executions
    earlier: tuple[State, ...]  # of the code, the oldest first
    today: State
    timing: Timing | None  # at the rate of today's code, or of the last that was tried

    @property
    def holds(self) -> bool:
        """All done, and none bad."""
        return self.today.bad == 0 and self.today.done >= self.planned


def planned(item: Item, folder: Path) -> int:
    """Trials of the whole proof."""
    return item.count(prepared(item, folder))


def row(item: Item, folder: Path, states: Sequence[State]) -> Row:
    """By its gathered states."""
    *earlier, today = states
    count = planned(item, folder)
    last_tried = today if today.done or not earlier else earlier[-1]
    return Row(item, count * item.executions, tuple(earlier), today, timing(item, last_tried, count))


def states_of(item: Item, folder: Path, published: Path) -> tuple[State, ...]:
    """What is published of it, and what is kept in the folder of today's code."""
    return gathered(read(published).get(item.name, ()), item.code, kept_lines(_file(item, folder)))


def publish(items: Sequence[Item], folder: Path, published: Path) -> dict[str, tuple[State, ...]]:
    """Add what is kept in the folder."""
    states = {item.name: states_of(item, folder, published) for item in items}
    write(published, states)
    return states


def prepared(item: Item, folder: Path) -> Path:
    """What the item's trials begin with, made where it is missing."""
    inputs = folder / "inputs" / item.code
    inputs.mkdir(parents=True, exist_ok=True)
    item.prepare(inputs)
    return inputs


@contextmanager
def workers(processes: int, at_end: Callable[[], object]) -> Iterator[ProcessPoolExecutor]:
    """Processes for trials; they end with this one, also where it is asked to end, which does the last thing then."""
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
        at_end()
        sys.stderr.flush()
        os._exit(1)  # the pool's own end may wait for ever on its queue of parts, which nobody reads any more
    pool.shutdown()


def left(item: Item, folder: Path, published: Path, numbers: Iterable[int]) -> list[list[int]]:
    """Those that are neither published nor kept, in parts that are run at a time."""
    known = states_of(item, folder, published)[-1].known
    todo = [number for number in numbers if number not in known]
    return [todo[first : first + item.at_once] for first in range(0, len(todo), item.at_once)]


def begin(item: Item, folder: Path, numbers: Sequence[int], pool: ProcessPoolExecutor) -> "Future[None]":
    """Have one part run, behind what was begun before."""
    return pool.submit(_run_part, item, folder, prepared(item, folder), numbers)


def finish(name: str, parts: Parts) -> bool:
    """Wait for them; False where they could not all be run."""
    started_s, whole = time.monotonic(), True
    for done, part in enumerate(as_completed(parts), 1):
        whole &= _told(part)
        left_min = (time.monotonic() - started_s) / done * (len(parts) - done) / 60.0
        print(f"\r{name}: {done} of {len(parts)} parts, {left_min:.0f} min left ", end="", file=sys.stderr)
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


def _run_part(item: Item, folder: Path, inputs: Path, numbers: Sequence[int]) -> None:
    """Some trials, unless this process is asked to end."""
    try:
        run_trials(item, _file(item, folder), inputs, numbers)
    except (SystemExit, KeyboardInterrupt):  # all is cleared away; the pool would take it for a part that failed
        os._exit(1)


def _file(item: Item, folder: Path) -> Path:
    return folder / f"{item.name}.jsonl"
