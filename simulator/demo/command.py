"""`coaxial demo`: pedicle screws from C-arm to sleeve in a simulated room, or the room left up for a person."""

from pathlib import Path
from typing import Annotated

import typer

demo = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)

PedicleOption = Annotated[
    list[str] | None,
    typer.Option(
        "--pedicle",
        help="A pedicle to place, L1-left to L5-right (repeatable). "
        "[default: L3 and L4, both sides; with a CT all that are planned]",
    ),
]
DataOption = Annotated[
    Path | None,
    typer.Option(
        "--data", help="An empty folder for the database and the logs. [default: a new temporary one; both are kept]"
    ),
]
PortOption = Annotated[int, typer.Option("--port", min=0, max=65535, help="Port of the service; 0 takes a free one.")]
StayOption = Annotated[
    bool, typer.Option("--stay", help="Run no procedure: leave service and room up, and print the sign-in.")
]
FaultOption = Annotated[
    list[str] | None, typer.Option("--fault", help="Inject a fault into the room before the first target (repeatable).")
]
TruthOption = Annotated[
    Path | None, typer.Option("--truth", help="The room's hidden errors, and a CT as the patient (TOML).")
]


@demo.command()
def demo_command(
    pedicle: PedicleOption = None,
    data: DataOption = None,
    port: PortOption = 0,
    stay: StayOption = False,
    fault: FaultOption = None,
    truth: TruthOption = None,
) -> None:
    """Place pedicle screws in a simulated room, over the same protocols as in a real one.

    Starts the service and the room as processes of their own on loopback, then does what the people of an operating
    room do: C-arm into the view, exposure, target, approval with the PIN, held motion, verification, correction where
    the limits ask for it, sleeve. Prints what was moved and measured beside what the room knows to be true.

    Exit status: 0 all targets placed; 1 something failed, and the last line says what, as what the room does not know
    of pedicles, faults or truth, before anything is started; 130 interrupted.
    """
    from simulator.demo.run import run
    from simulator.demo.wanted import Wanted

    raise typer.Exit(run(Wanted(tuple(pedicle or ()), data, port, stay, tuple(fault or ()), truth)))
