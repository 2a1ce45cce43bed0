"""`coaxial db`: bring the database up to date, back it up, restore it. Exit status: 0 done, 3 refused."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from service.settings import Settings

db = typer.Typer(add_completion=False, pretty_exceptions_enable=False, no_args_is_help=True)

_REFUSED = 3
ConfigOption = Annotated[Path | None, typer.Option(help="Settings file (TOML); COAXIAL_ variables win.")]
DataFolderOption = Annotated[Path | None, typer.Option(help="Where the database is kept.")]


@db.callback()
def databases() -> None:
    """The database: upgrade, backup, restore."""


@db.command()
def upgrade(
    role: Annotated[str | None, typer.Option(help="PostgreSQL: the role that services sign in with.")] = None,
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Bring the schema up to date in one transaction; nothing of the record is lost or changed."""
    from service.database.current import current_database
    from service.database.migrate import version_of
    from service.database.rights import grant_rights

    with _settings(config, data_folder) as settings, current_database(settings) as database:
        if role is not None:
            with database.write() as connection:
                grant_rights(connection, role)
        typer.echo(f"the database is at version {version_of(database)}")


@db.command()
def backup(file: Path, config: ConfigOption = None, data_folder: DataFolderOption = None) -> None:
    """Write the whole database to a new file, also while the service runs; the copy holds the entry that says so."""
    from service.audit import record_audit
    from service.database.backup import back_up
    from service.database.current import current_database

    with _settings(config, data_folder) as settings, current_database(settings) as database:
        with database.write() as connection:
            record_audit(connection, "backed_up", None, {"file": file.name})
        back_up(database, file)
        typer.echo(f"backed up to {file}")


@db.command()
def restore(file: Path, config: ConfigOption = None, data_folder: DataFolderOption = None) -> None:
    """Bring a backup into an empty database; then `coaxial audit verify` says what is missing since."""
    from service.database.backup import restore as bring_back
    from service.database.engines import open_database

    with _settings(config, data_folder) as settings:
        settings.data_folder.mkdir(parents=True, exist_ok=True)
        database = open_database(settings.database_url)
        try:
            bring_back(database, file)
        finally:
            database.close()
        typer.echo(f"restored from {file}")


@contextmanager
def _settings(config: Path | None, data_folder: Path | None) -> "Iterator[Settings]":
    from service.errors import ServiceError, answer_for
    from service.settings import load_settings

    try:
        yield load_settings(config, {} if data_folder is None else {"data_folder": data_folder})
    except ServiceError as error:
        typer.echo(f"{error.code}: {error.message}. {answer_for(error.code).what_to_do}", err=True)
        raise typer.Exit(_REFUSED) from error
