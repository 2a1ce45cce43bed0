"""`coaxial db`: bring the database up to date, back it up, restore it. Exit status: 0 done, 3 refused."""

from pathlib import Path
from typing import Annotated

import typer

from service.cli.plain import plain_typer
from service.cli.site import ConfigOption, DataFolderOption, site_settings

db = plain_typer(no_args_is_help=True)


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
    from service.database.current import keyless_database
    from service.database.migrate import version_of
    from service.database.rights import grant_rights

    with site_settings(config, data_folder) as settings, keyless_database(settings) as database:
        if role is not None:
            with database.write() as connection:
                grant_rights(connection, role)
        typer.echo(f"the database is at version {version_of(database)}")


@db.command()
def backup(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A new file; it holds everything, patients too.")],
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Write the whole database to a new file, also while the service runs; the copy holds the entry that says so.

    A database of an older version is copied as it is, and not upgraded, before an upgrade is tried.
    """
    from service.audit import record_audit
    from service.database.backup import back_up
    from service.database.current import database_as_it_is
    from service.database.migrate import is_current, version_of

    with site_settings(config, data_folder) as settings, database_as_it_is(settings) as database:
        if is_current(database):
            with database.write() as connection:
                record_audit(connection, "backed_up", None, {"file": file.name})
        else:
            typer.echo(f"of version {version_of(database)}: copied as it is, and no entry says so", err=True)
        back_up(database, file)
        typer.echo(f"backed up to {file}")


@db.command()
def restore(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="What `coaxial db backup` wrote.")],
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Bring a backup into an empty database; then `coaxial audit verify` says what is missing since."""
    from service.database.backup import check_backup
    from service.database.backup import restore as bring_back
    from service.database.current import make_data_folder
    from service.database.engines import open_database

    with site_settings(config, data_folder) as settings:
        check_backup(file, settings.database_url)
        make_data_folder(settings)
        database = open_database(settings.database_url)
        try:
            bring_back(database, file)
        finally:
            database.close()
        typer.echo(f"restored from {file}")
