"""The page of the changes that tests notice, made from the published results."""

from collections.abc import Sequence

from benchmarks.mutation.packages import Package
from benchmarks.mutation.scores import Score, reasons

_HEAD = """# Do the tests notice?

Made by `make mutation` from its [results](mutation.json), which go with the code; written by no hand. Each part of the
rules and of the guard is changed by itself: a comparison, a constant, an operator, a condition, a returned value, an
exception that is raised or caught, a statement or an entry of a table left out. A change is found if a test fails, or
never ends. Prose, annotations and constant subscripts stay as they are.

Tried are the tests of the package that reach the changed line and keep no real time; what only the simulated room, the
fault matrix or the whole service would find counts as missed. For the rules the search of every reachable case and the
comparison of the table with its page are left out too. What Python itself refuses to load, and what means the same as
before, counts neither way. Changes are tried in an order drawn from their names; one that no test noticed is tried
again once a test changes, and counts as missed until then. `at least` counts what was not tried as missed.

| what | tried | not tried | refused by Python | mean the same | found | missed | of those tried | at least | asked |
|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|
"""
_ASKED = 0.9


def page(rows: Sequence[tuple[Package, Score]]) -> str:
    """Markdown: a table of all, then what was missed, and why some changes are none."""
    table = "\n".join(_row(package, score) for package, score in rows)
    missed = "\n".join(f"- `{mutant.key}`" for _, score in rows for mutant in score.missed)
    same = "\n".join(f"- `{key}`: {reason}" for key, reason in sorted(reasons().items()))
    return f"{_HEAD}{table}\n\n## What was missed\n\n{missed}\n\n## What means the same\n\n{same}\n"


def _row(package: Package, score: Score) -> str:
    counts = (score.tried, score.left, score.stillborn, score.equivalent, score.found, len(score.missed))
    shares = (f"{100.0 * share:.1f} %" for share in (score.share_of_tried, score.share))
    cells = (package.what, *(f"{count:,}" for count in counts), *shares, f"{100.0 * _ASKED:.0f} %")
    return f"| {' | '.join(cells)} |"


def holds(score: Score) -> bool:
    """As many are found as asked for."""
    return score.share >= _ASKED
