"""The page of the evidence, made from its results."""

import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.evidence.item import Item, Summary

_MENDED = Path(__file__).parent / "mended.toml"
_PROCESSES = 2  # that the budget is reckoned with
_HEAD = """# Evidence

Made by `make evidence` from its results; written by no hand. Trials are numbered, and a number is its seed: the same
number is the same trial. `at most` is the share of bad trials that 95 % confidence leaves open (Clopper and Pearson).

A result counts for the code that it was made with, and for no other. `code` is the fingerprint of what a row's trials
run: every file of the project that they come to by imports, and the versions of all libraries. Where one of these
files changes, the row begins anew, and what was done before is told below it. `make evidence SHARE=0` runs nothing and
writes this page with the fingerprints of the tree that it runs in.

Sequences and contested permits are sent to the whole service over its own sockets; scripted are the guard's client, the
image work and the monotonic clock, which stands still between two steps. Kills at random moments are of `coaxial serve`
as a process, with its guard, over a simulated controller.

Of fuzzing and of requests each execution counts. A decoder that ends its process, or works for more than a second of
its own time, counts as bad, though the image worker bears both: its next image finds a new process.

| what | asked | done | of | bad | at most | holds | hours | code |
|---|---|---:|---:|---:|---:|---|---:|---|
"""
_BELOW = """
`hours` is what all of a row takes on two cores, at the rate of the results that are kept; a row without any has none.
"""


def page(rows: Sequence[tuple[Item, Sequence[Summary]]]) -> str:
    """Markdown: a table of today's code, what it consists of, what was done of earlier code, what was mended.

    The summaries of an item begin with that of today's code.
    """
    today = [(item, found[0]) for item, found in rows]
    table = "\n".join(
        _row(item, figures, _hours(found)) for (item, figures), (_, found) in zip(today, rows, strict=True)
    )
    known = [hours for _, found in rows if (hours := _hours(found)) is not None]
    total = f"Together {sum(known):.1f} hours for {len(known)} of {len(rows)} rows.\n"
    parts = [f"- **{item.name}**: {_kinds(figures)}." for item, figures in today if figures.done]
    earlier = [_earlier(item, figures) for item, found in rows for figures in found[1:]]
    sections = [
        _section("What was tried", parts),
        _section("Earlier states of the code", [_EARLIER_HEAD, *earlier] if earlier else []),
        _section("Found and mended", _mended()),
    ]
    return f"{_HEAD}{table}\n{_BELOW}{total}" + "".join(sections)


def _section(title: str, lines: Iterable[str]) -> str:
    text = "\n".join(lines)
    return f"\n## {title}\n\n{text}\n" if text else ""


def _row(item: Item, figures: Summary, hours: float | None) -> str:
    holds = "yes" if figures.holds else ("no" if figures.bad else "not all run")
    cells = (item.what, item.asked, f"{figures.done:,}", f"{figures.planned:,}", f"{figures.bad:,}")
    last = ("" if hours is None else f"{hours:.2f}", f"`{figures.code}`")
    return f"| {' | '.join(cells)} | {100 * figures.share_95:.3g} % | {holds} | {' | '.join(last)} |"


def _hours(found: Sequence[Summary]) -> float | None:
    """For all of an item, at the rate of its code or of the last that was tried."""
    rates = (one.seconds for one in (found[0], *reversed(found[1:])) if one.seconds is not None)
    rate = next(rates, None)
    return None if rate is None else rate * found[0].planned / _PROCESSES / 3600.0


def _kinds(figures: Summary) -> str:
    return ", ".join(f"{kind} {count:,}" for kind, count in sorted(figures.kinds.items()))


_EARLIER_HEAD = """Counted in no row above: one of the files has changed since.

| what | code | commits | done | bad |
|---|---|---|---:|---:|"""


def _earlier(item: Item, figures: Summary) -> str:
    commits = ", ".join(figures.commits)
    return f"| {item.what} | `{figures.code}` | {commits} | {figures.done:,} | {figures.bad:,} |"


def _mended() -> list[str]:
    """From the kept list."""
    found = tomllib.loads(_MENDED.read_text())["found"]
    return [f"- **{one['by']}**: {one['what']} *Mended:* {one['mended']}" for one in found]
