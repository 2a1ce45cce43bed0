"""`coaxial serve`: the service of one room."""

from pathlib import Path
from typing import Annotated, Any

import typer

serve = typer.Typer(add_completion=False, pretty_exceptions_enable=False)

_REFUSED = 3


@serve.command()
def serve_command(
    config: Annotated[Path | None, typer.Option(help="Settings file (TOML); COAXIAL_ variables win.")] = None,
    data_folder: Annotated[Path | None, typer.Option(help="Where the database is kept.")] = None,
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="HTTP port; 0 takes a free one.")] = None,
    claim_room: Annotated[
        str | None, typer.Option(help="Reason to claim the room from another workstation, which is dead.")
    ] = None,
) -> None:
    """Run the service of one room until it is interrupted; prints its address once it answers."""
    from service.errors import ServiceError, answer_for
    from service.serving import run
    from service.settings import load_settings
    from service.structured_log import configure_log

    overrides: dict[str, Any] = {} if data_folder is None else {"data_folder": data_folder}
    if port is not None:
        overrides["http"] = {"port": port}
    configure_log()
    try:
        run(load_settings(config, overrides), claim_room or None)
    except ServiceError as error:
        typer.echo(f"{error.code}: {error.message}. {answer_for(error.code).what_to_do}", err=True)
        raise typer.Exit(_REFUSED) from error
