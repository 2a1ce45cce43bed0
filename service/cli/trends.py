"""`coaxial trends`: figures of all finished cases by device, and which of them drift.

Exit status: 0 charted, whatever was found; 3 refused, as with too few cases.
"""

from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Annotated

import typer

from service.cli.plain import plain_typer
from service.cli.site import ConfigOption, DataFolderOption, site_settings
from service.cli.streams import print_line, write_file

if TYPE_CHECKING:
    from service.trends.series import Series, Trends

_FEW = 5  # cases whose median stands at either end of the table
trends = plain_typer()


@trends.command()
def trends_command(
    out: Annotated[Path | None, typer.Option(metavar="FOLDER", help="Where the plots go, one of each device.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object instead of the table.")] = False,
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Errors, residuals, distortion, exposures and time across cases, by guide, C-arm and TCP calibration."""
    from service.database.current import present_database
    from service.trends.figures import finished_cases
    from service.trends.series import chart_trends, to_json

    with site_settings(config, data_folder) as settings, present_database(settings) as database:
        with database.read() as connection:
            cases = finished_cases(connection)
        charted = chart_trends(cases)
    if out is not None:
        _plot(charted, out)
    if as_json:
        print_line(to_json(charted))
    else:
        _print_table(charted)


def _plot(charted: "Trends", folder: Path) -> None:
    from service.trends.plot import plot

    devices = {(one.kind, one.device): None for one in charted.series}
    for number, (kind, device) in enumerate(devices, start=1):
        shown = [one for one in charted.series if (one.kind, one.device) == (kind, device)]
        write_file(folder / f"trends-{number}-{kind}.png", plot(shown))


def _print_table(charted: "Trends") -> None:
    from rich.console import Console
    from rich.table import Table

    from service.trends.series import FALSE_ALARMS

    table = Table(title=f"Trends of {charted.cases} finished cases")
    for heading in ("device", "measure"):
        table.add_column(heading)
    for heading in ("cases", f"first {_FEW}", f"last {_FEW}", "chart", "limit"):
        table.add_column(heading, justify="right")
    table.add_column("drift")
    for number, one in enumerate(charted.series):
        last = number + 1 == len(charted.series) or charted.series[number + 1].device != one.device
        table.add_row(*_cells(one), style="bold red" if one.signals else None, end_section=last)
    console = Console()
    console.print(table)
    console.print(
        "first, last: medians of so many cases. chart: the newest CUSUM of the cases' ranks, in standard deviations; "
        f"where nothing drifts, anything at all is flagged in at most {FALSE_ALARMS:.0%} of such tables"
    )


def _cells(series: "Series") -> tuple[str, ...]:
    values = series.values
    drifts = [f"{one.per_case:+.2g} a case since case {one.since + 1}, seen at {one.at + 1}" for one in series.signals]
    return (
        f"{series.kind} {series.device}",
        series.measure,
        str(len(values)),
        f"{median(values[:_FEW]):.3g}",
        f"{median(values[-_FEW:]):.3g}",
        " / ".join(f"{chart.sums[-1]:.1f}" for chart in series.charts),
        f"{series.charts[0].limit:.1f}",
        "; ".join(drifts),
    )
