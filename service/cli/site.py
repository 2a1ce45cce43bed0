"""What every command on a site's record begins with: its settings, and one line where something refuses."""

import getpass
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from service.settings import Settings

REFUSED = 3
ConfigOption = Annotated[Path | None, typer.Option(help="Settings file (TOML); COAXIAL_ variables win over it.")]
DataFolderOption = Annotated[
    Path | None, typer.Option(help="Database, keys, journal; ~/.local/share/coaxial if not told.")
]


@contextmanager
def in_one_line(status: int = REFUSED) -> Iterator[None]:
    """A ServiceError within ends the command with `status`; it and what to do are said in one line on stderr."""
    from service.errors import ServiceError, answer_for

    try:
        yield
    except ServiceError as error:
        end = "" if error.message.endswith("?") else "."
        typer.echo(f"{error.code}: {error.message}{end} {answer_for(error.code).what_to_do}", err=True)
        raise typer.Exit(status) from error


@contextmanager
def site_settings(config: Path | None, data_folder: Path | None, status: int = REFUSED) -> "Iterator[Settings]":
    """The settings for a command; a ServiceError within ends it with `status`, said on stderr."""
    from service.ledger.speaker import speak_as
    from service.settings import load_settings

    speak_as("command line", _account())
    with in_one_line(status):
        yield load_settings(config, {} if data_folder is None else {"data_folder": data_folder})


def _account() -> str:
    """Who runs the command; by number where the machine has no name for it, as in a container."""
    try:
        return getpass.getuser()
    except KeyError:
        return str(os.getuid())
