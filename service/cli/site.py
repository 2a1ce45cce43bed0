"""What every command on a site's record begins with: its settings, and one line where something refuses."""

import getpass
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from service.settings import Settings

REFUSED = 3
ConfigOption = Annotated[Path | None, typer.Option(help="Settings file (TOML); COAXIAL_ variables win.")]
DataFolderOption = Annotated[Path | None, typer.Option(help="Where the database is kept.")]


@contextmanager
def site_settings(config: Path | None, data_folder: Path | None, status: int = REFUSED) -> "Iterator[Settings]":
    """The settings for a command; a ServiceError within ends it with `status`, said on stderr."""
    from service.errors import ServiceError, answer_for
    from service.ledger.speaker import speak_as
    from service.settings import load_settings

    speak_as("command line", getpass.getuser())
    try:
        yield load_settings(config, {} if data_folder is None else {"data_folder": data_folder})
    except ServiceError as error:
        typer.echo(f"{error.code}: {error.message}. {answer_for(error.code).what_to_do}", err=True)
        raise typer.Exit(status) from error
