"""Brings the schema up to date, all of it or nothing."""

from pathlib import Path

import alembic.command
from alembic.config import Config
from alembic.util import CommandError

import migrations
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError


def migrate(database: Database, revision: str = "head") -> None:
    """Run the missing migrations in one transaction; ServiceError SCHEMA_UNKNOWN if the database is newer than this."""
    config = Config()
    config.set_main_option("script_location", str(Path(migrations.__file__).parent).replace("%", "%%"))
    try:
        with database.write() as connection:
            config.attributes["connection"] = connection
            alembic.command.upgrade(config, revision)
    except CommandError as error:
        raise ServiceError(
            ErrorCode.SCHEMA_UNKNOWN, "the database was written by another version of this program"
        ) from error
