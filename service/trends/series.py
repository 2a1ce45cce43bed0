"""The charts of a site: every measure by every device that enough cases used, at a chance of false alarm for all."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np

from service.devices.store import DeviceKind
from service.errors import ErrorCode, ServiceError
from service.trends.chart import FEWEST_CASES, WINDOW_CASES, Chart, Signal, Way, drift_chart
from service.trends.figures import CHARTED_DEVICES, CaseFigures, Measure

# That anything at all is flagged where nothing drifts, in WINDOW_CASES cases; shared out among all charts (Bonferroni).
FALSE_ALARMS = 0.01
# Errors, exposures and time that fall are no harm; a distortion that falls is another distortion.
_WAYS = dict.fromkeys(Measure, (Way.RISING,)) | {Measure.DISTORTION: (Way.RISING, Way.FALLING)}


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """One measure of the newest cases with one device, oldest first, and a chart of each way that would be harm."""

    measure: Measure
    kind: DeviceKind
    device: str
    cases: tuple[CaseFigures, ...]
    charts: tuple[Chart, ...]

    @property
    def values(self) -> list[float]:
        """The measure of each case."""
        return [case.values[self.measure] for case in self.cases]

    @property
    def signals(self) -> tuple[Signal, ...]:
        """The first signal of each chart that crossed its limit."""
        return tuple(chart.signal for chart in self.charts if chart.signal is not None)


@dataclass(frozen=True, slots=True, eq=False)
class Trends:
    """Every chart that the record has enough cases for."""

    cases: int
    series: tuple[Series, ...]

    @property
    def drifting(self) -> tuple[Series, ...]:
        """The charts to look at."""
        return tuple(one for one in self.series if one.signals)


def chart_trends(cases: Sequence[CaseFigures]) -> Trends:
    """Charts of all measures by guide, C-arm and TCP calibration; ServiceError TOO_FEW_CASES if there is none."""
    groups = [group for group in _groups(cases) if len(group[3]) >= FEWEST_CASES]
    if not groups:
        most = max((len(chosen) for _, _, _, chosen in _groups(cases)), default=0)
        text = f"no device has {FEWEST_CASES} finished cases with figures yet, {most} at most"
        raise ServiceError(ErrorCode.TOO_FEW_CASES, text, measured=most, limit=FEWEST_CASES)
    false_signals = FALSE_ALARMS / _sides(groups)
    return Trends(len(cases), tuple(_series(*group, false_signals) for group in groups))


def to_json(trends: Trends) -> dict[str, Any]:
    """The charts as they are printed and answered: cases by their ids, no patients."""
    return {
        "status": "charted",
        "cases": trends.cases,
        "false_alarms": FALSE_ALARMS,
        "drifting": len(trends.drifting),
        "series": [_series_to_json(one) for one in trends.series],
    }


_Group = tuple[Measure, DeviceKind, str, tuple[CaseFigures, ...]]


def _groups(cases: Sequence[CaseFigures]) -> Iterator[_Group]:
    for kind in CHARTED_DEVICES:
        for device in sorted({case.devices[kind] for case in cases if kind in case.devices}):
            used = [case for case in cases if case.devices.get(kind) == device]
            for measure in Measure:
                yield measure, kind, device, tuple(case for case in used if measure in case.values)[-WINDOW_CASES:]


def _sides(groups: Sequence[_Group]) -> int:
    """How many charts can raise a false alarm: those of the same cases, where devices always come together, do once."""
    different = {(measure, tuple(case.case_id for case in cases)) for measure, _, _, cases in groups}
    return sum(len(_WAYS[measure]) for measure, _ in different)


def _series(
    measure: Measure, kind: DeviceKind, device: str, cases: tuple[CaseFigures, ...], false_signals: float
) -> Series:
    values = np.array([case.values[measure] for case in cases])
    charts = tuple(drift_chart(values, way, false_signals) for way in _WAYS[measure])
    return Series(measure, kind, device, cases, charts)


def _series_to_json(series: Series) -> dict[str, Any]:
    return {
        "measure": series.measure.value,
        "device_kind": series.kind.value,
        "device": series.device,
        "cases": [case.case_id for case in series.cases],
        "values": series.values,
        "median": median(series.values),
        "charts": {chart.way.value: _chart_to_json(chart, series) for chart in series.charts},
    }


def _chart_to_json(chart: Chart, series: Series) -> dict[str, Any]:
    signal = chart.signal
    told = None
    if signal is not None:
        at, since = series.cases[signal.at].case_id, series.cases[signal.since].case_id
        told = {"at_case": at, "since_case": since, "per_case": signal.per_case}
    return {"sums": chart.sums.tolist(), "limit": chart.limit, "signal": told}
