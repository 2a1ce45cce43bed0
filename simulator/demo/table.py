"""The table at the end of a run."""

from collections.abc import Sequence

from rich.table import Table

from simulator.demo.results import TargetResult, Verified

# The paper's ten laboratory alignments, at 80 mm below the end-effector.
PAPER_MAX_DEG, PAPER_MAX_MM = 0.94, 1.31
_CAPTION = "angle in deg, position in mm 80 mm below the guide (true: at the pedicle); + marks a corrective motion"


def result_table(results: Sequence[TargetResult]) -> Table:
    """One row a target, the maxima, and the paper's maxima."""
    table = Table(caption=_CAPTION)
    table.add_column("target")
    for name in ("moved, mm", "turned, deg", "contour", "95 % bound", "paper's way", "true", "X-rays", "time, s"):
        table.add_column(name, justify="right")
    for result in results:
        table.add_row(*_row(result))
    table.add_section()
    table.add_row(*_largest(results))
    table.add_row("paper, maximum", "", "", _pair(PAPER_MAX_DEG, PAPER_MAX_MM), *[""] * 5)
    return table


def _row(result: TargetResult) -> tuple[str, ...]:
    final = result.final
    return (
        result.name,
        " + ".join(f"{one.translation_mm:.1f}" for one in result.moved),
        " + ".join(f"{one.rotation_deg:.2f}" for one in result.moved),
        _pair(final.contour_deg, final.contour_mm),
        _pair(final.bound_deg, final.bound_mm),
        _pair(final.paper_deg, final.paper_mm),
        _pair(final.true.angle_deg, final.true.position_mm),
        str(result.exposures),
        f"{result.elapsed_s:.1f}",
    )


def _largest(results: Sequence[TargetResult]) -> tuple[str, ...]:
    finals: list[Verified] = [result.final for result in results]
    return (
        "maximum",
        "",
        "",
        _pair(max(one.contour_deg for one in finals), max(one.contour_mm for one in finals)),
        _pair(max(one.bound_deg for one in finals), max(one.bound_mm for one in finals)),
        _pair(max(one.paper_deg for one in finals), max(one.paper_mm for one in finals)),
        _pair(max(one.true.angle_deg for one in finals), max(one.true.position_mm for one in finals)),
        str(sum(result.exposures for result in results)),
        f"{sum(result.elapsed_s for result in results):.1f}",
    )


def _pair(angle_deg: float, position_mm: float) -> str:
    return f"{angle_deg:.3f}  {position_mm:.3f}"
