"""How soon `coaxial trends` sees a planted drift, and how often it sees one that is not there.

    python -m benchmarks.trends --reports 2000

Each target's error is a vector across the guide's axis with a skewed spread, of which the record keeps the length; a
drift moves its middle by so much a case, as a calibration that wanders would. The other five measures do not drift.
Whole reports are charted, by guide, C-arm and TCP calibration, and anything flagged where nothing drifts is false.
"""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest

from benchmarks.kept import at_least_one
from service.devices.store import DeviceKind
from service.trends.chart import WINDOW_CASES
from service.trends.figures import CaseFigures, Measure
from service.trends.series import chart_trends

Array = NDArray[np.float64]
WITHIN_CASES = 20
_SEED = 20261122
_DRIFT_MM = 0.02


@dataclass(frozen=True, slots=True)
class Room:
    """How a site works: median error of one target, targets of a case, and how many devices of each kind take turns."""

    median_mm: float
    targets: int = 1
    devices: int = 1
    skew: float = 0.5  # standard deviation of the logarithm of the error's scale, target by target


def errors_mm(room: Room, drifts_mm: Array, rng: np.random.Generator) -> Array:
    """The median error of each case (n,), where the middle of the errors lies `drifts_mm` (n,) off the axis."""
    shape = (len(drifts_mm), room.targets)
    scales = rng.lognormal(0.0, room.skew, shape)
    offsets = rng.standard_normal((*shape, 2)) * scales[..., None]
    offsets *= room.median_mm / _median_length(room.skew)
    offsets[..., 0] += drifts_mm[:, None]
    return np.asarray(np.median(np.linalg.norm(offsets, axis=-1), axis=1))


def _median_length(skew: float) -> float:
    rng = np.random.default_rng(_SEED)
    return float(np.median(np.linalg.norm(rng.standard_normal((20_000, 2)), axis=1) * rng.lognormal(0, skew, 20_000)))


def cases_of(room: Room, position_mm: Array, rng: np.random.Generator) -> list[CaseFigures]:
    """Cases with these position errors, everything else as skewed and without a drift; exposures are small counts."""
    others = {measure: rng.lognormal(0.0, room.skew, len(position_mm)) for measure in Measure}
    others[Measure.EXPOSURES] = 2.0 + rng.poisson(0.4, len(position_mm))
    values = others | {Measure.POSITION_ERROR: position_mm}
    kinds = (DeviceKind.GUIDE, DeviceKind.CARM, DeviceKind.TCP)
    used = rng.integers(0, room.devices, (len(position_mm), len(kinds)))
    return [
        CaseFigures(
            case_id=str(number),
            opened_at="",
            values={measure: float(one[number]) for measure, one in values.items()},
            devices={kind: f"{kind} {which}" for kind, which in zip(kinds, used[number], strict=True)},
        )
        for number in range(len(position_mm))
    ]


def is_seen(room: Room, clean: int, drift_mm: float, rng: np.random.Generator) -> bool:
    """Whether a drift behind so many clean cases is flagged within WITHIN_CASES, and nothing before it began."""
    drifts_mm = drift_mm * np.maximum(0, np.arange(clean + WITHIN_CASES) - clean + 1)
    trends = chart_trends(cases_of(room, errors_mm(room, drifts_mm, rng), rng))
    signals = [s for one in trends.series if one.measure is Measure.POSITION_ERROR for s in one.signals]
    return bool(signals) and all(signal.at >= clean for signal in signals)


def is_false(room: Room, cases: int, rng: np.random.Generator) -> bool:
    """Whether anything at all is flagged in a report where nothing drifts."""
    return bool(chart_trends(cases_of(room, errors_mm(room, np.zeros(cases), rng), rng)).drifting)


def share(reports: int, trial: Callable[[], bool]) -> str:
    """How many of the trials, with the 95 % bounds by Clopper and Pearson."""
    count = sum(trial() for _ in range(reports))
    bounds = binomtest(count, reports).proportion_ci(method="exact")
    return f"{count:5d} of {reports}   {count / reports:7.2%}   ({bounds.low:.2%} to {bounds.high:.2%})"


def smallest_seen_mm(room: Room, clean: int, reports: int, rng: np.random.Generator) -> float:
    """The smallest drift a case, to a tenth, that 95 % of the reports flag within WITHIN_CASES cases."""
    low, high = 0.001, 1.0
    while high / low > 1.1:
        middle = float(np.sqrt(low * high))
        seen = sum(is_seen(room, clean, middle, rng) for _ in range(reports))
        low, high = (low, middle) if seen >= 0.95 * reports else (middle, high)
    return high


def main(arguments: Sequence[str] | None = None) -> None:
    """Print all figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reports", type=at_least_one, default=2000, help="simulated records of each line")
    reports = parser.parse_args(arguments).reports
    rng = np.random.default_rng(_SEED)
    print(f"seed {_SEED}; 95 % bounds in brackets")
    print(f"\nnothing drifts: reports of {WINDOW_CASES} cases in which anything is flagged")
    for skew in (0.0, 0.5, 1.0):
        for devices in (1, 2):
            room = Room(0.05, skew=skew, devices=devices)
            line = share(reports, lambda room=room: is_false(room, WINDOW_CASES, rng))
            print(f"  skew {skew:.1f}, {devices} of each device    {line}", flush=True)
    print(f"\na drift of {_DRIFT_MM} mm a case: reports that flag it within {WITHIN_CASES} cases, and nothing before")
    for clean in (0, 20):
        for median_mm in (0.02, 0.035, 0.05, 0.1):
            for targets in (1, 4):
                room = Room(median_mm, targets)
                line = share(reports, lambda room=room, clean=clean: is_seen(room, clean, _DRIFT_MM, rng))
                print(f"  behind {clean:2d} cases, median {median_mm:.3f} mm, {targets} targets    {line}", flush=True)
    print(f"\nthe smallest drift a case that 95 % of the reports flag within {WITHIN_CASES} cases")
    for clean in (0, 20):
        for median_mm in (0.05, 0.1, 0.2):
            smallest_mm = smallest_seen_mm(Room(median_mm, 2), clean, max(reports // 10, 50), rng)
            print(
                f"  behind {clean:2d} cases, median {median_mm:.2f} mm, 2 targets    {smallest_mm:.3f} mm", flush=True
            )


if __name__ == "__main__":
    main()
