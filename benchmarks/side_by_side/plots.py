"""One plot for every table: all values, not their summaries."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from benchmarks.side_by_side.poses import PoseScore
from benchmarks.side_by_side.rings import RingScore
from benchmarks.side_by_side.strategies import Outcome

mpl.use("Agg")
_SIZE = (13.0, 5.0)
_MARKERS = "os^Dvx"


def plot_poses(scores: Sequence[PoseScore], file: Path) -> None:
    """Share of images against angle and against distance."""
    figure, (angle, position) = plt.subplots(1, 2, figsize=_SIZE, sharey=True, layout="constrained")
    for method in dict.fromkeys(score.method for score in scores):
        mine = [score for score in scores if score.method == method and score.angle_deg is not None]
        _share(angle, [score.angle_deg for score in mine], method)
        _share(position, [score.position_mm for score in mine], method)
    angle.set(xlabel="angle between the moved guide and the target's ray, deg", ylabel="share of images", xscale="log")
    position.set(xlabel="distance of the target from the axis, mm", xscale="log")
    angle.legend(loc="upper left", fontsize="small")
    figure.suptitle("The same 12 fiducials, by method")
    _save(figure, file)


def plot_rings(scores: Sequence[RingScore], file: Path) -> None:
    """Centre errors, and what was missed or false, of every finder."""
    finders = list(dict.fromkeys(score.finder for score in scores))
    figure, (error, count) = plt.subplots(1, 2, figsize=_SIZE, layout="constrained")
    for place, finder in enumerate(finders):
        mine = [score for score in scores if score.finder == finder]
        errors = [value for score in mine for value in score.centre_errors_px]
        spread = np.linspace(-0.25, 0.25, max(len(errors), 1))[: len(errors)]
        error.plot(errors, place + spread, ".", markersize=4)
        missed = 2 * len(mine) - len(errors)
        count.barh(place - 0.2, missed / (2 * len(mine)), height=0.35, color="tab:red")
        count.barh(place + 0.2, np.mean([score.false for score in mine]), height=0.35, color="tab:gray")
    error.set(
        xscale="log", xlabel="error of a found ring's centre, px", yticks=range(len(finders)), yticklabels=finders
    )
    count.set(yticks=[], xlabel="red: share of rings missed; grey: false ellipses an image", xscale="symlog")
    for axes in (error, count):
        axes.set_ylim(len(finders) - 0.5, -0.5)
    figure.suptitle("Ring finders on the same straightened images")
    _save(figure, file)


def plot_strategies(outcomes: Sequence[Outcome], file: Path) -> None:
    """Error at the target and angle against exposures, one mark a room."""
    figure, (angle, position) = plt.subplots(1, 2, figsize=_SIZE, sharex=True, layout="constrained")
    names = list(dict.fromkeys(outcome.strategy for outcome in outcomes))
    for index, name in enumerate(names):
        mine = [outcome for outcome in outcomes if outcome.strategy == name and outcome.errors is not None]
        exposures = np.array([outcome.exposures for outcome in mine]) + (index - len(names) / 2.0) * 0.1
        angle.plot(exposures, [outcome.errors.angle_deg for outcome in mine], _MARKERS[index], alpha=0.6, label=name)
        position.plot(exposures, [outcome.errors.position_mm for outcome in mine], _MARKERS[index], alpha=0.6)
    angle.set(yscale="log", xlabel="exposures (marks moved apart)", ylabel="angle, deg")
    position.set(
        yscale="log", xlabel="exposures (marks moved apart)", ylabel="distance of the target from the axis, mm"
    )
    angle.legend(fontsize="small")
    figure.suptitle("Whole strategies in the same simulated rooms")
    _save(figure, file)


def _share(axes: Axes, values: list[float | None], label: str) -> None:
    known = np.sort([value for value in values if value is not None])
    if len(known):
        share = np.arange(len(known) + 1) / len(known)
        axes.step(np.append(known[0], known), share, where="post", label=label)
    axes.grid(alpha=0.3, which="both")


def _save(figure: plt.Figure, file: Path) -> None:
    figure.savefig(file, dpi=110)
    plt.close(figure)
