"""The three tables of a run, for a screen and as plain values."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.side_by_side.poses import PoseScore
from benchmarks.side_by_side.rings import RingScore
from benchmarks.side_by_side.strategies import Outcome

Row = dict[str, Any]
Scored = TypeVar("Scored", PoseScore, RingScore, Outcome)

_WIDTH = 170


def pose_rows(scores: Sequence[PoseScore]) -> list[Row]:
    """A line for every method."""
    return [_pose_row(name, rows) for name, rows in _by(scores, lambda score: score.method)]


def ring_rows(scores: Sequence[RingScore]) -> list[Row]:
    """A line for every finder."""
    return [_ring_row(name, rows) for name, rows in _by(scores, lambda score: score.finder)]


def strategy_rows(outcomes: Sequence[Outcome]) -> list[Row]:
    """A line for every strategy."""
    return [_strategy_row(name, rows) for name, rows in _by(outcomes, lambda outcome: outcome.strategy)]


def print_table(title: str, rows: Sequence[Row]) -> None:
    """One table on standard output."""
    table = Table(title=title, title_justify="left", expand=False)
    for name in rows[0]:
        table.add_column(name, justify="left" if name == "what" else "right", no_wrap=name == "what")
    for row in rows:
        table.add_row(*(_text(value) for value in row.values()))
    Console(width=_WIDTH).print(table)


def _pose_row(name: str, scores: Sequence[PoseScore]) -> Row:
    solved = [score for score in scores if score.angle_deg is not None]
    return {
        "what": name,
        "images": len(scores),
        "failed": len(scores) - len(solved),
        **_spread("deg", [score.angle_deg for score in solved]),
        **_spread("mm", [score.position_mm for score in solved]),
        "CPU ms": float(np.median([score.cpu_ms for score in scores])),
    }


def _ring_row(name: str, scores: Sequence[RingScore]) -> Row:
    errors = [error for score in scores for error in score.centre_errors_px]
    return {
        "what": name,
        "rings": 2 * len(scores),
        "missed": 2 * len(scores) - len(errors),
        "false, an image": float(np.mean([score.false for score in scores])),
        **_spread("px", errors),
        "CPU ms": float(np.median([score.cpu_ms for score in scores])),
    }


def _strategy_row(name: str, outcomes: Sequence[Outcome]) -> Row:
    placed = [outcome.errors for outcome in outcomes if outcome.errors is not None]
    exposures = [outcome.exposures for outcome in outcomes]
    return {
        "what": name,
        "rooms": len(outcomes),
        "gave up": len(outcomes) - len(placed),
        "X-rays": float(np.mean(exposures)),
        "most": max(exposures),
        **_spread("deg", [errors.angle_deg for errors in placed]),
        **_spread("mm", [errors.position_mm for errors in placed]),
        "time s": float(np.median([outcome.time_s for outcome in outcomes])),
    }


def _spread(unit: str, values: Iterable[float | None]) -> Row:
    """Median, 95th percentile and greatest of absolute errors; nothing where there are none."""
    known = np.array([value for value in values if value is not None])
    if not len(known):
        return {f"{unit} median": None, f"{unit} 95 %": None, f"{unit} max": None}
    return {
        f"{unit} median": float(np.median(known)),
        f"{unit} 95 %": float(np.percentile(known, 95.0)),
        f"{unit} max": float(known.max()),
    }


def _by(scores: Sequence[Scored], key: Callable[[Scored], str]) -> list[tuple[str, list[Scored]]]:
    """Groups in the order in which they first occur."""
    names = dict.fromkeys(key(score) for score in scores)
    return [(name, [score for score in scores if key(score) == name]) for name in names]


def _text(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.3f}" if abs(value) < 10.0 else f"{value:.0f}"
    return str(value)
