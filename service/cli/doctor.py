"""`coaxial doctor`: whether this machine could run the room now, and what to do where not.

Exit status: 0 all is well, 3 something is not, 2 wrong usage.
"""

import json
from typing import Annotated

import typer

from service.cli.plain import plain_typer
from service.cli.site import REFUSED, ConfigOption, DataFolderOption, site_settings

doctor = plain_typer()


@doctor.command()
def doctor_command(
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object instead of lines.")] = False,
) -> None:
    """Look at disk, clock, database, keys, users, device files, arm and DICOM; change nothing."""
    from dataclasses import asdict

    from service.cli.check_lines import tell
    from service.operations.doctor import examine

    with site_settings(config, data_folder) as settings:
        items = [asdict(one) for one in examine(settings)]
    passed = all(one["passed"] for one in items)
    if as_json:
        typer.echo(json.dumps({"passed": passed, "items": items}))
    else:
        tell(items)
    if not passed:
        raise typer.Exit(REFUSED)
