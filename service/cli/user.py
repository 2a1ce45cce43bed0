"""`coaxial user`: who may sign in. The first user is made here, on the machine itself."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from service.auth.permissions import Role
from service.cli.plain import plain_typer
from service.cli.secret import secret
from service.cli.site import ConfigOption, DataFolderOption, site_settings

if TYPE_CHECKING:
    from service.auth.users import UserStore

user = plain_typer(no_args_is_help=True)


@user.callback()
def users() -> None:
    """Who may sign in."""


@user.command()
def add(
    name: Annotated[str, typer.Argument(help="Name to sign in with.")],
    role: Annotated[Role, typer.Option(help="What the user may do.")],
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """Add a user; password and PIN from COAXIAL_PASSWORD and COAXIAL_PIN, else two lines of stdin, else asked for."""
    password = secret("COAXIAL_PASSWORD", "Password", twice=True)
    pin = secret("COAXIAL_PIN", "PIN", twice=True)
    with _user_store(config, data_folder, makes_it=True) as store:
        added = store.add(name, role, password, pin)
    typer.echo(f"added {added.name} as {added.role}")


@user.command("list")
def list_users(config: ConfigOption = None, data_folder: DataFolderOption = None) -> None:
    """Every user who may sign in, with the role."""
    with _user_store(config, data_folder) as store:
        for one in store.list():
            typer.echo(f"{one.name}\t{one.role}")


@user.command()
def disable(
    name: Annotated[str, typer.Argument(help="Name to sign in with.")],
    config: ConfigOption = None,
    data_folder: DataFolderOption = None,
) -> None:
    """End a user's access and sessions; the records keep the name."""
    with _user_store(config, data_folder) as store:
        store.disable(name)
    typer.echo(f"disabled {name}")


@contextmanager
def _user_store(config: Path | None, data_folder: Path | None, *, makes_it: bool = False) -> "Iterator[UserStore]":
    """The users of a database; only the first user's is made where there is none."""
    from service.auth.users import UserStore
    from service.database.current import current_database, present_database

    opened = current_database if makes_it else present_database
    with site_settings(config, data_folder) as settings, opened(settings) as database:
        yield UserStore(database)
