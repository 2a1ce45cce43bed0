"""`coaxial simulate`: a simulated operating room. `coaxial demo`: a whole procedure in one."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from simulator.demo.command import demo

__all__ = ["demo", "simulate"]

simulate = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)

_USAGE = 2
_DEFAULT_ARM = "127.0.1.10"  # a controller's three ports are fixed, so that each needs an address of its own


@simulate.command()
def simulate_room(
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of the HTTP door on 127.0.0.1.")] = 8710,
    arm_address: Annotated[str, typer.Option(help="Loopback address of the UR5 controller.")] = _DEFAULT_ARM,
    dicom_host: Annotated[str, typer.Option(help="Where the C-arm sends its images.")] = "127.0.0.1",
    dicom_port: Annotated[int, typer.Option(min=1, max=65535, help="Port of the DICOM receiver.")] = 11112,
    dicom_ae_title: Annotated[str, typer.Option(help="AE title of the DICOM receiver.")] = "COAXIAL",
    truth: Annotated[
        Path | None,
        typer.Option(help="Hidden errors, and a CT as the patient (TOML); what it leaves out has a default."),
    ] = None,
) -> None:
    """An operating room that speaks only real protocols: a UR5 controller, a C-arm, a prone patient, and an HTTP door.

    The arm answers on its address at ports 29999, 30003 and 30004. The door positions the C-arm, exposes, jogs the
    arm and plants faults (GET /faults lists them, GET /room tells the rest). Runs until it is interrupted.
    """
    from simulator.carm.sending import Destination
    from simulator.running import run
    from simulator.truth import read_truth

    try:
        known = read_truth(truth.read_bytes(), truth.parent) if truth else read_truth()
        run(arm_address, port, Destination(dicom_host, dicom_port, dicom_ae_title), known)
    except (ValueError, OSError) as error:
        sys.stderr.write(f"simulate: {error}\n")
        raise typer.Exit(_USAGE) from None
