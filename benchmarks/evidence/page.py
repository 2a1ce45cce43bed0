"""The page of the evidence, made from its results."""

import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.evidence.item import Item, Trial
from benchmarks.evidence.published import State
from benchmarks.evidence.runs import Row
from benchmarks.evidence.timing import Timing

_MENDED = Path(__file__).parent / "mended.toml"
_HEAD = """# Evidence

Made by `make evidence` from its results; written by no hand. Trials are numbered, and a number is its seed: the same
number is the same trial. `at most` is the share of bad trials that 95 % confidence leaves open (Clopper and Pearson).

A result counts for the code that it was made with, and for no other. `code` is the fingerprint of what a row's trials
run: every file of the project that they come to by imports, without comments and docstrings, and the versions of all
libraries. Where one of these changes, the row begins anew, and what was done before is told below it. `make evidence
SHARE=0` runs nothing and writes this page with the fingerprints of the tree that it runs in.

The [results](evidence.json) beside this page go with the code: which numbers are done, counts, sums of times, and every
bad trial whole. A run adds to them what it did, however it ends, and runs only what they lack: so a row may be gathered
over several days, each on another machine.

Sequences and contested permits are sent to the whole service over its own sockets; scripted are the guard's client, the
image work and the monotonic clock, which stands still between two steps. Kills at random moments are of `coaxial serve`
as a process, with its guard, over a simulated controller; most are forked from a process that has imported everything,
and one in twenty starts whole.

Of fuzzing and of requests each execution counts. A decoder that ends its process, or works for more than a second of
its own time, counts as bad, though the image worker bears both: its next image finds a new process.

A trial that raises an error of its own, the harness's too, is bad with all its executions; the numbers behind it are
run nevertheless. Where nothing can be tried, none is counted, and the run fails.

| what | asked | done | of | bad | at most | holds | hours | code |
|---|---|---:|---:|---:|---:|---|---:|---|
"""
_BELOW = """
`hours` is what all of a row takes on two cores, at the rate of the results that are kept; a row without any has none.
Trials that calculate are timed by the processor's time, those that wait by the clock: on a machine that has other work
too (`load`: processes that wanted one of its cores, with the trials' own) these take longer than on one that has none.
"""


def page(rows: Sequence[Row]) -> str:
    """Markdown: a table of today's code, what it consists of, what was done of earlier code, what was mended."""
    table = "\n".join(_row(row) for row in rows)
    known = [row.timing.hours for row in rows if row.timing is not None]
    total = f"Together {sum(known):.1f} hours for {len(known)} of {len(rows)} rows.\n"
    parts = [f"- **{row.item.name}**: {_kinds(row.today)}." for row in rows if row.today.done]
    raised = [f"- **{row.item.name}** {_told(trial)}" for row in rows for trial in row.today.raised]
    earlier = [_earlier(row.item, state) for row in rows for state in row.earlier]
    sections = [
        _section("What was tried", parts),
        _section("Raised", raised),
        _section("Earlier states of the code", [_EARLIER_HEAD, *earlier] if earlier else []),
        _section("Found and mended", _mended()),
    ]
    return f"{_HEAD}{table}\n{_BELOW}{total}" + "".join(sections)


def _section(title: str, lines: Iterable[str]) -> str:
    text = "\n".join(lines)
    return f"\n## {title}\n\n{text}\n" if text else ""


def _row(row: Row) -> str:
    item, today = row.item, row.today
    holds = "yes" if row.holds else ("no" if today.bad else "not all run")
    cells = (item.what, item.asked, f"{today.done:,}", f"{row.planned:,}", f"{today.bad:,}")
    last = (_hours(row.timing), f"`{today.code}`")
    return f"| {' | '.join(cells)} | {100 * today.share_95:.3g} % | {holds} | {' | '.join(last)} |"


def _hours(timing: Timing | None) -> str:
    if timing is None:
        return ""
    return f"{timing.hours:.2f}" if timing.load is None else f"{timing.hours:.2f}, load {timing.load:.0f}"


def _kinds(state: State) -> str:
    return ", ".join(f"{kind} {count:,}" for kind, count in sorted(state.kinds.items()))


def _told(trial: Trial) -> str:
    return f"{trial['number']}: {trial['error']}, {trial['place']}."


_EARLIER_HEAD = """Counted in no row above: one of the files has changed since. Of each row three: those with the most
bad trials, then those with the most trials.

| what | code | commits | done | bad |
|---|---|---|---:|---:|"""


def _earlier(item: Item, state: State) -> str:
    commits = ", ".join(state.commits)
    return f"| {item.what} | `{state.code}` | {commits} | {state.done:,} | {state.bad:,} |"


def _mended() -> list[str]:
    """From the kept list."""
    found = tomllib.loads(_MENDED.read_text())["found"]
    return [f"- **{one['by']}**: {one['what']} *Mended:* {one['mended']}" for one in found]
