"""Brings the schema up to date, all of it or nothing."""

from pathlib import Path

import alembic.command
import sqlalchemy as sa
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


def schema_revision(database: Database) -> str | None:
    """The revision that the database is at; None for one without a schema."""
    with database.read() as connection:
        if not sa.inspect(connection).has_table("alembic_version"):
            return None
        return connection.execute(sa.text("SELECT version_num FROM alembic_version")).scalar()
