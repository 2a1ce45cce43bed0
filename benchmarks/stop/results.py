"""Trials kept as lines of a file, and what they amount to."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

_BINS_MS = (0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 75, 100, 150, 200, 300, 440, 1000)
_BAR = 50


@dataclass(frozen=True, slots=True)
class Trial:
    """One measured stop, or one motion that was to arrive."""

    latency_ms: float | None  # from the cause to the wire; None where none is measured
    good: bool  # accepted; or, of a motion, not ended by a stop that nobody wanted
    state: str


@dataclass(frozen=True, slots=True)
class Limits:
    """What is required of a kind of trial; None where nothing is."""

    p99_ms: float | None = None
    largest_ms: float | None = None
    bad: int = 0


class Kept:
    """The trials of one kind, of this run and of those before it."""

    def __init__(self, folder: Path, kind: str) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.kind = kind
        self._path = folder / f"{kind}.jsonl"
        self.trials = [Trial(**line) for line in self._lines()]

    def add(self, trial: Trial) -> None:
        """Keep one more."""
        self.trials.append(trial)
        with self._path.open("a") as file:
            file.write(json.dumps(asdict(trial)) + "\n")

    def _lines(self) -> list[dict[str, object]]:
        """All whole lines; the last one may have been cut off."""
        if not self._path.exists():
            return []
        return [json.loads(line) for line in self._path.read_text().splitlines() if line.endswith("}")]


def summary(kept: Kept, limits: Limits) -> dict[str, object]:
    """Counts, percentiles and whether the limits hold."""
    latencies_ms = np.array([trial.latency_ms for trial in kept.trials if trial.latency_ms is not None])
    bad = sum(not trial.good for trial in kept.trials)
    figures: dict[str, object] = {"kind": kept.kind, "trials": len(kept.trials), "bad": bad}
    holds = bad <= limits.bad
    if latencies_ms.size:
        names, shares = ("p50_ms", "p90_ms", "p99_ms", "p99_9_ms"), (50, 90, 99, 99.9)
        figures |= dict(zip(names, np.percentile(latencies_ms, shares).round(2).tolist(), strict=True))
        figures["largest_ms"] = round(float(latencies_ms.max()), 2)
        holds = holds and all(
            limit is None or float(figures[name]) <= limit  # type: ignore[arg-type]  # set a line above
            for name, limit in (("p99_ms", limits.p99_ms), ("largest_ms", limits.largest_ms))
        )
    return figures | {"limits": asdict(limits), "holds": bool(holds)}


def histogram(kept: Kept) -> str:
    """Trials by latency, a line for each bin that is not empty."""
    latencies_ms = [trial.latency_ms for trial in kept.trials if trial.latency_ms is not None]
    counts, _ = np.histogram(latencies_ms, bins=(-np.inf, *_BINS_MS, np.inf))
    edges = ["<", *(f"{edge}" for edge in _BINS_MS)]
    rows = [
        f"  {low:>5} ms {count:6d} {'#' * int(np.ceil(_BAR * count / max(counts)))}"
        for low, count in zip(edges, counts, strict=True)
        if count
    ]
    return "\n".join(rows)
