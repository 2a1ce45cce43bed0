"""The database of a command or of the service, ready to be used."""

from collections.abc import Iterator
from contextlib import contextmanager

from service.database.engines import Database, open_database
from service.database.free_space import check_free_space
from service.database.migrate import migrate
from service.ledger.anchor import advance_anchor
from service.ledger.keys import signing_key
from service.settings import Settings


@contextmanager
def current_database(settings: Settings) -> Iterator[Database]:
    """The database with the newest schema, for a command or the service; ServiceError where disk or schema refuse."""
    settings.data_folder.mkdir(parents=True, exist_ok=True)
    check_free_space(settings.data_folder, settings.min_free_bytes)
    signer = signing_key(settings.key_file)
    database = open_database(settings.database_url, signer)
    try:
        migrate(database)
        yield database
        advance_anchor(database, settings.anchor_file, signer)
    finally:
        database.close()
