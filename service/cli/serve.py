"""`coaxial serve`: the service of one room."""

from typing import Annotated, Any

import typer

from service.cli.plain import plain_typer
from service.cli.site import ConfigOption, DataFolderOption, in_one_line

serve = plain_typer()


@serve.command()
def serve_command(
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
    port: Annotated[
        int | None,
        typer.Option(min=0, max=65535, help="HTTP port, else that of the settings (8700); 0 takes a free one."),
    ] = None,
    claim_room: Annotated[
        str | None, typer.Option(help="Reason to claim the room from another workstation, which is dead.")
    ] = None,
) -> None:
    """Run the service of one room until it is interrupted; prints its address once it answers."""
    from service.serving import run
    from service.settings import load_settings
    from service.structured_log import configure_log

    overrides: dict[str, Any] = {} if data_folder is None else {"data_folder": data_folder}
    if port is not None:
        overrides["http"] = {"port": port}
    configure_log()
    with in_one_line():
        run(load_settings(config, overrides), claim_room or None)
