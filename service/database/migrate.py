"""Brings the schema up to date, all of it or nothing."""

from pathlib import Path

import alembic.command
import sqlalchemy as sa
from alembic.config import Config
from alembic.util import CommandError
from sqlalchemy.engine import Connection

import migrations
from service.database import tables
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.ledger.beginning import begin_ledger


def migrate(database: Database, revision: str = "head") -> None:
    """Run the missing migrations in one transaction; ServiceError SCHEMA_UNKNOWN if the database is newer than this."""
    config = Config()
    config.set_main_option("script_location", str(Path(migrations.__file__).parent).replace("%", "%%"))
    try:
        with database.write() as connection:
            config.attributes["connection"] = connection
            had_ledger = _has_ledger(connection)
            alembic.command.upgrade(config, revision)
            if _has_ledger(connection) and not had_ledger:
                begin_ledger(connection, database.signer)
    except CommandError as error:
        raise ServiceError(
            ErrorCode.SCHEMA_UNKNOWN, "the database was written by another version of this program"
        ) from error


def _has_ledger(connection: Connection) -> bool:
    return sa.inspect(connection).has_table(tables.ledger.name)
