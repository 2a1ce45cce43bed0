"""The database of a command or of the service, ready to be used."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import sqlalchemy as sa

from service.database import tables
from service.database.engines import Database, open_database
from service.database.free_space import check_free_space
from service.database.migrate import is_current, migrate, version_of
from service.errors import ErrorCode, ServiceError
from service.ledger.anchor import advance_anchor
from service.ledger.keys import kept_key, signing_key
from service.settings import Settings


@contextmanager
def current_database(settings: Settings) -> Iterator[Database]:
    """The database with the newest schema, for what signs the record: a command or the service.

    Made, and its key, where there is none; ServiceError where disk, schema or key refuse, KEY_MISSING where the record
    was signed before and its key is not here.
    """
    with _opened(settings) as database:
        if database.signer is None:
            _check_unsigned(settings, database)
            database.signer = signing_key(settings.key_file)
        yield from _brought_up_to_date(settings, database)


@contextmanager
def present_database(settings: Settings) -> Iterator[Database]:
    """As `keyless_database`, for what reads what is there; ServiceError DATABASE_MISSING, and nothing is made."""
    check_present(settings)
    with keyless_database(settings) as database:
        yield database


@contextmanager
def keyless_database(settings: Settings) -> Iterator[Database]:
    """As `current_database`, for what need not sign: it makes no key, and without one nothing is signed or anchored."""
    with _opened(settings) as database:
        yield from _brought_up_to_date(settings, database)


@contextmanager
def _opened(settings: Settings) -> Iterator[Database]:
    make_data_folder(settings)
    check_free_space(settings.data_folder, settings.min_free_bytes)
    database = open_database(settings.database_url, kept_key(settings.key_file))
    try:
        yield database
    finally:
        database.close()


def _brought_up_to_date(settings: Settings, database: Database) -> Iterator[Database]:
    migrate(database)
    yield database
    if database.signer is not None:
        advance_anchor(database, settings.anchor_file, database.signer)


def _check_unsigned(settings: Settings, database: Database) -> None:
    """A new key beside a record that another one signed would make the sound past look forged."""
    with database.read() as connection:
        if not sa.inspect(connection).has_table(tables.checkpoints.name):
            return
        signed = connection.execute(sa.select(sa.func.max(tables.checkpoints.c.sequence))).scalar()
    if signed is not None:
        raise ServiceError(
            ErrorCode.KEY_MISSING,
            f"the record is signed up to entry {signed}, and the key is not here: {settings.key_file}",
            measured=signed,
        )


@contextmanager
def database_as_it_is(settings: Settings) -> Iterator[Database]:
    """The database with whatever schema it has, none made and none changed; ServiceError DATABASE_MISSING."""
    check_present(settings)
    signer = kept_key(settings.key_file)
    database = open_database(settings.database_url, signer)
    try:
        if version_of(database) is None:
            raise ServiceError(ErrorCode.DATABASE_MISSING, "the database is empty")
        yield database
        if signer is not None and is_current(database):
            advance_anchor(database, settings.anchor_file, signer)
    finally:
        database.close()


def check_present(settings: Settings) -> None:
    """ServiceError DATABASE_MISSING where the settings name a file that is not there: opening it would make it."""
    address = sa.make_url(settings.database_url)
    if address.get_backend_name() == "sqlite" and not Path(str(address.database)).is_file():
        raise ServiceError(
            ErrorCode.DATABASE_MISSING, f"there is no database {address.database}: is the data folder the one meant?"
        )


def make_data_folder(settings: Settings) -> None:
    """The data folder, where there is none yet its owner's alone; ServiceError SETTINGS_REFUSED."""
    folder = settings.data_folder
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        message = f"the data folder {folder} cannot be made ({error.strerror})"
        raise ServiceError(ErrorCode.SETTINGS_REFUSED, message) from error
