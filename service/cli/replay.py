"""`coaxial audit replay`: every result of past cases computed anew and compared with the record.

Exit status: 0 equal, 3 differences, 2 wrong usage, or no record that could be read.
"""

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

from service.cli.site import ConfigOption, DataFolderOption, site_settings

if TYPE_CHECKING:
    from service.database.engines import Database
    from service.replay.crews import Crew
    from service.replay.inputs import CaseInput, CaseReplay, Difference
    from service.settings import Settings

_USAGE, _DIFFERENT = 2, 3
_SHOWN = 20  # differences of one case


def replay(
    case: Annotated[
        str | None, typer.Argument(help="Id of the case, or an unambiguous beginning of it.", show_default=False)
    ] = None,
    everything: Annotated[bool, typer.Option("--all", help="Every case, oldest first.")] = False,
    workers: Annotated[int, typer.Option(help="Processes; they yield to other work.", min=1)] = 1,
    scheduler: Annotated[str | None, typer.Option(help="A Dask scheduler instead, as tcp://host:port.")] = None,
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Compute registrations, targets, plans and evaluations anew from the stored bytes; show what differs by 1e-9."""
    if (case is None) is not everything:
        typer.echo("name one case, or say --all", err=True)
        raise typer.Exit(_USAGE)
    from service.cores import use_one_core
    from service.database.current import present_database

    use_one_core()  # as the service computes
    with site_settings(config, data_folder, _USAGE) as settings, present_database(settings) as database:
        case_ids = _case_ids(database, case)
        with _crew(workers, scheduler) as crew:
            totals = _run(crew(_inputs(database, settings, case_ids)), len(case_ids))
        _record(database, case_ids, totals)
    if totals.differences:
        raise typer.Exit(_DIFFERENT)


@dataclass(slots=True)
class _Totals:
    """What was computed and found so far."""

    cases: int = 0
    results: int = 0
    differences: int = 0

    def add(self, one: "CaseReplay") -> None:
        """Count one case more."""
        self.cases += 1
        self.results += one.results
        self.differences += len(one.differences)


def _crew(workers: int, scheduler: str | None) -> "AbstractContextManager[Crew]":
    from service.replay.crews import on_a_cluster, on_this_machine

    return on_this_machine(workers) if scheduler is None else on_a_cluster(scheduler)


def _case_ids(database: "Database", case: str | None) -> list[str]:
    from service.cases import store

    with database.read() as connection:
        if case is not None:
            return [store.read_case(connection, store.whole_id(connection, case)).id]
        return [one.id for one in reversed(store.list_cases(connection))]


def _inputs(database: "Database", settings: "Settings", case_ids: list[str]) -> "Iterator[CaseInput]":
    from service.replay.reading import read_input

    for case_id in case_ids:
        with database.read() as connection:
            yield read_input(connection, case_id, settings)


def _run(replays: "Iterable[CaseReplay]", cases: int) -> _Totals:
    totals, started_s = _Totals(), time.monotonic()
    with _progress(cases) as advance:
        for one in replays:
            totals.add(one)
            advance(totals, time.monotonic() - started_s)
            _tell(one)
    took_s = max(time.monotonic() - started_s, 1e-3)
    rate = f"{took_s:.1f} s, {totals.results / took_s:.2f} results a second"
    equal = "all equal" if totals.results else "there is nothing to compute anew"
    found = f"{totals.differences} differences" if totals.differences else equal
    typer.echo(f"{totals.cases} cases, {totals.results} results in {rate}: {found}")
    return totals


@contextmanager
def _progress(cases: int) -> Iterator[Callable[[_Totals, float], None]]:
    """A bar on stderr, with how fast it goes."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    speed = TextColumn("{task.fields[speed]}")
    columns = ("cases", BarColumn(), MofNCompleteColumn(), speed, TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("cases", total=cases, speed="")
        yield lambda totals, took_s: bar.update(
            task, completed=totals.cases, speed=f"{totals.results / max(took_s, 1e-3):.2f} results/s"
        )


def _tell(one: "CaseReplay") -> None:
    for difference in one.differences[:_SHOWN]:
        typer.echo(f"case {one.case_id}: {_line(difference)}")
    if len(one.differences) > _SHOWN:
        typer.echo(f"case {one.case_id}: and {len(one.differences) - _SHOWN} more")


def _line(difference: "Difference") -> str:
    field = f" {difference.field}" if difference.field else ""
    return f"{difference.where}{field}: recorded {difference.recorded!r}, computed anew {difference.recomputed!r}"


def _record(database: "Database", case_ids: list[str], totals: _Totals) -> None:
    """Whoever reads the record is in it."""
    from service.audit import record_audit

    cases = case_ids[0] if len(case_ids) == 1 else len(case_ids)
    with database.write() as connection:
        record_audit(
            connection,
            "record_replayed",
            None,
            {"cases": cases, "results": totals.results, "differences": totals.differences},
        )
