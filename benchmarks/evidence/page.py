"""The page of the evidence, made from its results."""

from collections.abc import Sequence

from benchmarks.evidence.item import Item, Summary

_HEAD = """# Evidence

Made by `make evidence` from its results; written by no hand. Trials are numbered, and a number is its seed: the same
number is the same trial. `at most` is the share of bad trials that 95 % confidence leaves open (Clopper and Pearson).

Sequences and contested permits are sent to the whole service over its own sockets; scripted are the guard's client, the
image work and the monotonic clock, which stands still between two steps. Kills at random moments are of `coaxial serve`
as a process, with its guard, over a simulated controller.

Of fuzzing and of requests each execution counts. A decoder that ends its process, or works for more than a second of
its own time, counts as bad, though the image worker bears both: its next image finds a new process.

| what | asked | done | of | bad | at most | holds |
|---|---|---:|---:|---:|---:|---|
"""


def page(rows: Sequence[tuple[Item, Summary]]) -> str:
    """Markdown: a table of all, then what each consists of."""
    table = "\n".join(_row(item, figures) for item, figures in rows)
    parts = "\n".join(_part(item, figures) for item, figures in rows if figures.done)
    return f"{_HEAD}{table}\n\n## What was tried\n\n{parts}\n"


def _row(item: Item, figures: Summary) -> str:
    holds = "yes" if figures.holds else ("no" if figures.bad else "not all run")
    cells = (item.what, item.asked, f"{figures.done:,}", f"{figures.planned:,}", f"{figures.bad:,}")
    return f"| {' | '.join(cells)} | {100 * figures.share_95:.3g} % | {holds} |"


def _part(item: Item, figures: Summary) -> str:
    kinds = ", ".join(f"{kind} {count:,}" for kind, count in sorted(figures.kinds.items()))
    return f"- **{item.name}**: {kinds}."
