"""The `coaxial` command: subcommands are entry points, loaded only when they are called.

`register` and its siblings must start without importing the web stack or the database, and
`simulate` and `demo` live in a package that nothing may import; entry points give both. Command
modules import what is heavy inside their functions, so that `--help` stays quick.
"""

import errno
import os
import sys
from contextlib import suppress
from importlib.metadata import entry_points
from io import TextIOWrapper
from typing import Annotated, Any

import typer

from service.cli.plain import PlainGroup, plain_typer
from service.cores import use_one_core_for_algebra
from service.version import PRODUCT_VERSION

_GROUP = "coaxial.commands"
_UNUSABLE = 2
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


class LazyCommands(PlainGroup):
    """A command group whose members are resolved by entry point at call time."""

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002  # the base class passes it
        """Names of every installed subcommand, sorted."""
        return sorted(point.name for point in entry_points(group=_GROUP))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:  # noqa: ARG002  # the base class passes it
        """The command behind the entry point `cmd_name` (a Typer app), or None where there is none."""
        for point in entry_points(group=_GROUP, name=cmd_name):
            return typer.main.get_command(point.load())
        return None


app = plain_typer(cls=LazyCommands, no_args_is_help=True)


def _tell_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"coaxial {PRODUCT_VERSION}")
        raise typer.Exit


@app.callback()
def coaxial(
    _version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="Tell the version and end.")
    ] = False,
) -> None:
    """Robot-assisted needle placement under C-arm fluoroscopy. Research software, not for clinical use."""


def main() -> None:
    """Entry point of the installed command."""
    use_one_core_for_algebra()
    if isinstance(sys.stdout, TextIOWrapper):  # a name that the terminal has no letters for ends no command
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        app()
    except OSError as error:
        if error.errno not in _FULL:
            raise
        with suppress(OSError):  # where that goes may be full too
            typer.echo(f"error: {error.filename or 'what is printed is cut off'}: {error.strerror}", err=True)
        _drop_the_rest()
        sys.exit(_UNUSABLE)


def _drop_the_rest() -> None:
    """What could not be printed must not be tried again as the interpreter ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
