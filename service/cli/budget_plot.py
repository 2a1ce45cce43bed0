"""The plot of an error budget: each source's 95 % radius alone with its share, and all together."""

import math
from io import BytesIO

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vision.budget import Budget, ErrorSource
from vision.budget_check import Check, SourceCheck

_ALONE, _TOTAL, _DRAWN = "#4c86c6", "#c66a4c", "#222222"
_INCHES = (10.0, 4.2)


def plot(budget: Budget, checked: Check | None, alone: dict[ErrorSource, SourceCheck]) -> bytes:
    """A PNG file: angle at the left, position at the right; a diamond where draws came to, if there were any."""
    shares = {source.value: budget.share(source) for source in budget.covariances} | {"total": budget.whole()}
    checks = {source.value: one for source, one in alone.items()} | ({"total": checked} if checked else {})
    figure = Figure(figsize=_INCHES, layout="constrained")
    angle, position = figure.subplots(1, 2, sharey=True)
    radii_deg = {name: math.degrees(share.angle_rad) for name, share in shares.items()}
    radii_mm = {name: share.position_mm for name, share in shares.items()}
    _bars(angle, radii_deg, [share.angle_share for share in shares.values()], "angle, deg")
    _bars(position, radii_mm, [share.position_share for share in shares.values()], "position, mm")
    _diamonds(angle, radii_deg, {name: one.angle_ratio for name, one in checks.items()})
    _diamonds(position, radii_mm, {name: one.position_ratio for name, one in checks.items()})
    angle.invert_yaxis()
    draws = f"; diamonds: {checked.draws} draws" if checked else ""
    figure.suptitle(f"95 % of the targeting error by each source alone, and its share of the variance{draws}")
    stream = BytesIO()
    figure.savefig(stream, format="png", dpi=150)
    return stream.getvalue()


def _bars(axes: Axes, radii: dict[str, float], shares: list[float], label: str) -> None:
    colours = [_TOTAL if name == "total" else _ALONE for name in radii]
    bars = axes.barh(list(radii), list(radii.values()), color=colours)
    words = [f"{radius:.3f}   {share:.1%}" for radius, share in zip(radii.values(), shares, strict=True)]
    axes.bar_label(bars, labels=words, padding=6)
    axes.set_xlabel(label)
    axes.margins(x=0.3)
    axes.spines[["top", "right"]].set_visible(False)


def _diamonds(axes: Axes, radii: dict[str, float], ratios: dict[str, float | None]) -> None:
    """Where the linear radii would be if they were as the draws."""
    drawn = {name: ratio * radii[name] for name, ratio in ratios.items() if ratio is not None}
    axes.plot(list(drawn.values()), list(drawn), "D", color=_DRAWN, markersize=4)
