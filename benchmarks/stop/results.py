"""Trials kept as lines of a file, and what they amount to."""

import json
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import beta

_BINS_MS = (0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 75, 100, 150, 200, 300, 440, 1000)
_BAR = 50
_CONFIDENCE = 0.95  # one-sided
_TAIL = 0.01  # of a 99th percentile


class Verdict(StrEnum):
    """What the trials say about a limit."""

    HELD = "held"
    MISSED = "missed"
    UNDECIDED = "undecided"  # too few trials


@dataclass(frozen=True, slots=True)
class Trial:
    """One measured stop, or one motion that was to arrive."""

    latency_ms: float | None  # from the cause to the wire; None where none is measured
    good: bool  # accepted; or, of a motion, not ended by a stop that nobody wanted
    state: str
    counts: bool = True  # not where no motion began, and so none could be stopped


@dataclass(frozen=True, slots=True)
class Limits:
    """What is required of a kind of trial; None where nothing is."""

    p99_ms: float | None = None
    largest_ms: float | None = None
    bad_share: float | None = None  # None: not one


class Kept:
    """The trials of one kind, of this run and of those before it, those of rooms side by side (folders) included."""

    def __init__(self, folder: Path, kind: str) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.kind = kind
        self._folder = folder
        self._path = folder / f"{kind}.jsonl"
        trials = [Trial(**line) for line in self._lines()]
        self.trials = [trial for trial in trials if trial.counts]
        self.not_begun = len(trials) - len(self.trials)

    def add(self, trial: Trial) -> None:
        """Keep one more."""
        if trial.counts:
            self.trials.append(trial)
        else:
            self.not_begun += 1
        with self._path.open("a") as file:
            file.write(json.dumps(asdict(trial)) + "\n")

    def _lines(self) -> list[dict[str, Any]]:
        """All whole lines; the last one of a file may have been cut off."""
        texts = [path.read_text() for path in sorted(self._folder.rglob(self._path.name))]
        return [json.loads(line) for text in texts for line in text.splitlines() if line.endswith("}")]


def summary(kept: Kept, limits: Limits) -> dict[str, Any]:
    """Counts, percentiles, each state by itself, and a verdict on each limit."""
    verdicts = _verdicts(kept.trials, limits)
    states = sorted({trial.state for trial in kept.trials})
    by_state = {state: _figures([trial for trial in kept.trials if trial.state == state]) for state in states}
    figures = _figures(kept.trials) | {"not_begun": kept.not_begun}
    return {"kind": kept.kind} | figures | {"verdicts": verdicts, "states": by_state}


def _figures(trials: list[Trial]) -> dict[str, Any]:
    latencies_ms = _latencies_ms(trials)
    bad = sum(not trial.good for trial in trials)
    figures: dict[str, Any] = {"trials": len(trials), "bad": bad, "bad_share_at_most": _at_most(bad, len(trials))}
    if latencies_ms.size:
        names, shares = ("p50_ms", "p90_ms", "p99_ms", "p99_9_ms"), (50, 90, 99, 99.9)
        figures |= dict(zip(names, np.percentile(latencies_ms, shares).round(2).tolist(), strict=True))
        figures["largest_ms"] = round(float(latencies_ms.max()), 2)
    return figures


def _verdicts(trials: list[Trial], limits: Limits) -> dict[str, Verdict]:
    """On each limit; one that may be exceeded in a share of the trials needs enough of them."""
    latencies_ms = _latencies_ms(trials)
    bad = sum(not trial.good for trial in trials)
    verdicts = {"bad": _of_all(bad, trials) if limits.bad_share is None else _of_rate(bad, trials, limits.bad_share)}
    if limits.p99_ms is not None:
        verdicts["p99"] = _of_share(int((latencies_ms > limits.p99_ms).sum()), latencies_ms.size, _TAIL)
    if limits.largest_ms is not None:
        verdicts["largest"] = _of_all(int((latencies_ms > limits.largest_ms).sum()), trials)
    return verdicts


def _of_all(exceeding: int, trials: list[Trial]) -> Verdict:
    if exceeding:
        return Verdict.MISSED
    return Verdict.HELD if trials else Verdict.UNDECIDED


def _of_rate(exceeding: int, trials: list[Trial], share: float) -> Verdict:
    """As many as `share` of the trials, once there are enough for one to be allowed."""
    allowed = max(1, int(share * len(trials)))
    if exceeding > allowed:
        return Verdict.MISSED
    return Verdict.HELD if len(trials) * share >= 1.0 else Verdict.UNDECIDED


def _of_share(exceeding: int, count: int, share: float) -> Verdict:
    """Held where the true share is below the limit at the confidence asked for, missed where the seen one is not."""
    if count and exceeding / count > share:
        return Verdict.MISSED
    return Verdict.HELD if _at_most(exceeding, count) <= share else Verdict.UNDECIDED


def _at_most(hits: int, count: int) -> float:
    """Upper bound of a share that was seen so often (Clopper and Pearson), at `_CONFIDENCE`."""
    return 1.0 if hits >= count else float(beta.ppf(_CONFIDENCE, hits + 1, count - hits))


def _latencies_ms(trials: list[Trial]) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    return np.array([trial.latency_ms for trial in trials if trial.latency_ms is not None], dtype=np.float64)


def histogram(kept: Kept) -> str:
    """Trials by latency, a line for each bin that is not empty."""
    counts, _ = np.histogram(_latencies_ms(kept.trials), bins=(-np.inf, *_BINS_MS, np.inf))
    edges = ["<", *(f"{edge}" for edge in _BINS_MS)]
    rows = [
        f"  {low:>5} ms {count:6d} {'#' * int(np.ceil(_BAR * count / max(counts)))}"
        for low, count in zip(edges, counts, strict=True)
        if count
    ]
    return "\n".join(rows)
