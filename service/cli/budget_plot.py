"""The plot of an error budget: each source's 95 % radius alone, and all together."""

import math
from io import BytesIO

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vision.budget import Budget

_ALONE, _TOTAL = "#4c86c6", "#c66a4c"
_INCHES = (10.0, 4.2)


def plot(budget: Budget) -> bytes:
    """A PNG file: angle at the left, position at the right."""
    shares = {source.value: budget.share(source) for source in budget.covariances} | {"total": budget.whole()}
    figure = Figure(figsize=_INCHES, layout="constrained")
    angle, position = figure.subplots(1, 2, sharey=True)
    _bars(angle, {name: math.degrees(share.angle_rad) for name, share in shares.items()}, "angle, deg")
    _bars(position, {name: share.position_mm for name, share in shares.items()}, "position, mm")
    angle.invert_yaxis()
    figure.suptitle("95 % of the targeting error by each source alone")
    stream = BytesIO()
    figure.savefig(stream, format="png", dpi=150)
    return stream.getvalue()


def _bars(axes: Axes, radii: dict[str, float], label: str) -> None:
    colours = [_TOTAL if name == "total" else _ALONE for name in radii]
    bars = axes.barh(list(radii), list(radii.values()), color=colours)
    axes.bar_label(bars, fmt="%.3f", padding=3)
    axes.set_xlabel(label)
    axes.margins(x=0.15)
    axes.spines[["top", "right"]].set_visible(False)
