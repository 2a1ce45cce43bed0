"""The plot of the trends of one device: each measure case by case, and under it the chart with its limit."""

from collections.abc import Sequence
from io import BytesIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from service.trends.chart import Way
from service.trends.series import Series

_VALUE, _LIMIT, _DRIFT = "#4c86c6", "#222222", "#c6432e"
_SUMS = {Way.RISING: "#3f7f5f", Way.FALLING: "#8a6bb0"}
_UNITS = ("_mm", "_deg", "_px")
_ROW_INCHES, _WIDE_INCHES = 2.1, 11.0


def plot(series: Sequence[Series]) -> bytes:
    """A PNG file of the series of one device: values at the left, charts at the right; red where one crossed."""
    figure = Figure(figsize=(_WIDE_INCHES, 0.8 + _ROW_INCHES * len(series)), layout="constrained")
    figure.suptitle(f"{series[0].kind}: {series[0].device}")
    rows = figure.subplots(len(series), 2, squeeze=False)
    for row, one in zip(rows, series, strict=True):
        _draw_values(row[0], one)
        _draw_charts(row[1], one)
    for axes in rows[-1]:
        axes.set_xlabel("case", fontsize="small")
    stream = BytesIO()
    figure.savefig(stream, format="png", dpi=120)
    return stream.getvalue()


def _draw_values(axes: Axes, series: Series) -> None:
    values = np.array(series.values)
    axes.plot(np.arange(1, len(values) + 1), values, "o", color=_VALUE, markersize=3.5)
    axes.axhline(float(np.median(values)), color=_VALUE, linewidth=0.8, linestyle=":")
    for signal in series.signals:
        run = np.arange(signal.since, signal.at + 1)
        middle = float(np.median(values[run] - signal.per_case * run))
        axes.plot(run + 1, middle + signal.per_case * run, color=_DRIFT, linewidth=1.5)
        axes.plot(signal.at + 1, values[signal.at], "o", color=_DRIFT, markersize=7, fillstyle="none")
        axes.set_title(f"{signal.per_case:+.2g} a case since case {signal.since + 1}", color=_DRIFT, fontsize="small")
    name, _, unit = series.measure.rpartition("_") if series.measure.endswith(_UNITS) else (series.measure, "", "")
    _finish(axes, name.replace("_", " ") + (f", {unit}" if unit else ""))
    axes.set_ylim(bottom=min(0.0, float(values.min())))


def _draw_charts(axes: Axes, series: Series) -> None:
    for chart in series.charts:
        numbers, over = np.arange(1, len(chart.sums) + 1), chart.sums > chart.limit
        axes.plot(numbers, chart.sums, color=_SUMS[chart.way], label=chart.way.value)
        axes.plot(numbers[over], chart.sums[over], "o", color=_DRIFT, markersize=3.5)
    if len(series.charts) > 1:
        axes.legend(frameon=False, fontsize="small", loc="lower right", bbox_to_anchor=(1.0, 0.95), ncols=2)
    limit = series.charts[0].limit
    axes.axhline(limit, color=_LIMIT, linewidth=1.0, linestyle="--")
    axes.set_ylim(0.0, 1.15 * max(limit, *(float(chart.sums.max()) for chart in series.charts)))
    _finish(axes, "CUSUM of ranks, sd")


def _finish(axes: Axes, label: str) -> None:
    axes.set_ylabel(label, fontsize="small")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.spines[["top", "right"]].set_visible(False)
