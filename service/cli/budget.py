"""`coaxial budget`: what the targeting error is made of, by source."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.cli.geometry import CArmOption, DepthOption, GuideOption
from service.cli.plain import plain_typer
from service.cli.streams import print_line, read_device, read_registration, write_file

if TYPE_CHECKING:
    from vision.budget import Budget, ErrorSource, Share
    from vision.budget_check import Check, SourceCheck
    from vision.budget_conditions import Conditions
    from vision.motion_agreement import MotionErrors

budget = plain_typer()

_SEED = 1  # of the check: the same figures each time

_RegistrationOption = Annotated[Path | None, typer.Option(help="One line of `register`: its view, noise and plate.")]
_TcpOption = Annotated[
    Path | None, typer.Option(help="TCP calibration (TOML), for its standard deviations instead of --tcp-sd-....")
]


def _sd(of: str, unit: str) -> Any:
    return typer.Option(min=0.0, max=50.0, help=f"Standard deviation of {of}, {unit}.")


_CheckOption = Annotated[
    int, typer.Option("--check", min=0, max=1_000_000, help="Draws of a Monte Carlo check; 0: none.")
]


@budget.command()
def budget_command(
    guide: GuideOption,
    carm: CArmOption,
    registration: _RegistrationOption = None,
    tcp: _TcpOption = None,
    tcp_sd_mm: Annotated[float, _sd("the TCP calibration along each axis", "mm")] = 0.1,
    tcp_sd_deg: Annotated[float, _sd("the TCP calibration about each axis", "deg")] = 0.05,
    arm_sd_mm: Annotated[float, _sd("a reported pose along each axis", "mm")] = 0.1,
    arm_sd_deg: Annotated[float, _sd("a reported pose about each axis", "deg")] = 0.02,
    depth_mm: DepthOption = 80.0,
    depth_sd_mm: Annotated[float, _sd("the target's depth", "mm")] = 5.0,
    check: _CheckOption = 0,
    out: Annotated[Path | None, typer.Option(metavar="FOLDER", help="Where the plot goes.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object instead of the table.")] = False,
) -> None:
    """Each source's share in the targeting error, for the reference view or that of a registration."""
    from vision.budget import error_budget
    from vision.budget_check import check_budget, check_sources
    from vision.motion_agreement import MotionErrors

    if tcp is not None:
        tcp_sd_mm, tcp_sd_deg = _tcp_sd(tcp)
    motion = MotionErrors(math.radians(arm_sd_deg), arm_sd_mm, math.radians(tcp_sd_deg), tcp_sd_mm)
    conditions = _conditions(guide, carm, registration, motion, depth_sd_mm, depth_mm)
    result = error_budget(conditions)
    checked = check_budget(conditions, result, check, _SEED) if check else None
    alone = check_sources(conditions, result, check, _SEED) if check else {}
    if out is not None:
        from service.cli.budget_plot import plot

        write_file(out / "budget.png", plot(result, checked, alone))
    if as_json:
        print_line(_to_json(result, checked, alone))
    else:
        _print_table(result, checked, alone, depth_mm)


def _conditions(
    guide: Path, carm: Path, registration: Path | None, motion: "MotionErrors", depth_sd_mm: float, depth_mm: float
) -> "Conditions":
    from vision.alignment import check_depth
    from vision.budget_conditions import conditions_of, reference_conditions
    from vision.devices import read_carm, read_guide

    guide_file, carm_file = read_device(guide, read_guide), read_device(carm, read_carm)
    if registration is None:
        conditions = reference_conditions(guide_file, carm_file, motion, depth_sd_mm, depth_mm)
    else:
        registered = read_registration(registration)
        try:
            conditions = conditions_of(registered, guide_file, carm_file, motion, depth_sd_mm, depth_mm)
        except ValueError as error:
            raise typer.BadParameter(str(error)) from None
    refused = check_depth(conditions.view, guide_file, depth_mm)
    if refused is not None:
        raise typer.BadParameter(refused.message)
    return conditions


def _tcp_sd(path: Path) -> tuple[float, float]:
    from robot.tool import read_tool

    tool = read_device(path, read_tool)
    return tool.calibration_sd_mm, math.degrees(tool.calibration_sd_rad)


def _to_json(result: "Budget", checked: "Check | None", alone: "dict[ErrorSource, SourceCheck]") -> dict[str, Any]:
    sources = {source.value: _share_to_json(result.share(source)) for source in result.covariances}
    answer: dict[str, Any] = {"status": "budgeted", "sources": sources, "total": _share_to_json(result.whole())}
    if checked is not None:
        answer["check"] = {
            "draws": checked.draws,
            "rms_ratio": {"angle": checked.angle_ratio, "position": checked.position_ratio},
            "within_95": {"angle": checked.angle_within, "position": checked.position_within},
            "sources": {
                source.value: {"angle": one.angle_ratio, "position": one.position_ratio}
                for source, one in alone.items()
            },
        }
    return answer


def _share_to_json(share: "Share") -> dict[str, float]:
    return {
        "angle_95_deg": math.degrees(share.angle_rad),
        "position_95_mm": share.position_mm,
        "angle_share": share.angle_share,
        "position_share": share.position_share,
    }


def _print_table(
    result: "Budget", checked: "Check | None", alone: "dict[ErrorSource, SourceCheck]", depth_mm: float
) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    # Lines between columns would cost the names their ends in a terminal of 80.
    table = Table(title=f"Targeting error at {depth_mm:g} mm, 95 %", box=SIMPLE_HEAD, padding=0)
    table.add_column("source", no_wrap=True)
    drawn = ("deg drawn", "mm drawn") if checked else ()
    for heading in ("deg alone", "mm alone", "of angle", "of position", *drawn):
        table.add_column(heading, justify="right")
    last = list(result.covariances)[-1]
    for source in result.covariances:
        cells = (*_cells(result.share(source)), *_ratios(alone.get(source)))
        table.add_row(source.value, *cells, end_section=source is last)
    table.add_row("total", *_cells(result.whole()), *_ratios(checked))
    console = Console()
    console.print(table)
    if checked is not None:
        console.print(
            f"drawn: root mean square of {checked.draws} draws of the source alone, of the total of everything at "
            f"once, against the linear one; {checked.angle_within:.1%} and {checked.position_within:.1%} lie within "
            "the total's 95 % bounds"
        )


def _ratios(checked: "Check | SourceCheck | None") -> tuple[str, ...]:
    """Cells of the columns `drawn`."""
    if checked is None:
        return ()
    ratios = (checked.angle_ratio, checked.position_ratio)
    return tuple("" if ratio is None else f"x {ratio:.3f}" for ratio in ratios)


def _cells(share: "Share") -> tuple[str, ...]:
    angle_deg = math.degrees(share.angle_rad)
    return f"{angle_deg:.4f}", f"{share.position_mm:.4f}", f"{share.angle_share:.1%}", f"{share.position_share:.1%}"
