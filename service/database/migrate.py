"""Brings the schema up to date, all of it or nothing."""

from pathlib import Path

import alembic.command
import sqlalchemy as sa
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from alembic.util import CommandError
from psycopg.errors import InsufficientPrivilege
from sqlalchemy.engine import Connection
from sqlalchemy.exc import ProgrammingError

import migrations
from service.database import tables
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.ledger.beginning import begin_ledger


def migrate(database: Database, revision: str = "head") -> None:
    """Run the missing migrations in one transaction.

    Raises ServiceError SCHEMA_UNKNOWN if the database is newer than this program, SCHEMA_OLD if only its owner may
    upgrade it.
    """
    config = _config()
    try:
        with database.write() as connection:
            config.attributes["connection"] = connection
            had_ledger = _has_ledger(connection)
            alembic.command.upgrade(config, revision)
            if _has_ledger(connection) and not had_ledger:
                begin_ledger(connection, database.signer)
    except CommandError as error:
        message = "the database was written by a newer version of this program"
        raise _refusal(database, ErrorCode.SCHEMA_UNKNOWN, message) from error
    except ProgrammingError as error:
        if not isinstance(error.orig, InsufficientPrivilege):
            raise
        message = "the database is older than this program, and this role may not upgrade it"
        raise _refusal(database, ErrorCode.SCHEMA_OLD, message) from error


def version_of(database: Database) -> str | None:
    """The schema's version; None where there is no schema."""
    with database.read() as connection:
        return MigrationContext.configure(connection).get_current_revision()


def newest_version() -> str | None:
    """The schema's version that this program writes."""
    return ScriptDirectory.from_config(_config()).get_current_head()


def is_current(database: Database) -> bool:
    """Whether the schema is the one that this program writes."""
    return version_of(database) == newest_version()


def check_current(database: Database) -> None:
    """For what changes nothing, the schema neither: ServiceError SCHEMA_OLD, SCHEMA_UNKNOWN, DATABASE_MISSING."""
    version = version_of(database)
    if version is None:
        raise ServiceError(ErrorCode.DATABASE_MISSING, "the database is empty")
    if version == newest_version():
        return
    is_older = version in {script.revision for script in ScriptDirectory.from_config(_config()).walk_revisions()}
    code = ErrorCode.SCHEMA_OLD if is_older else ErrorCode.SCHEMA_UNKNOWN
    raise _refusal(database, code, f"the database is {'older' if is_older else 'newer'} than this program")


def _config() -> Config:
    config = Config()
    config.set_main_option("script_location", str(Path(migrations.__file__).parent).replace("%", "%%"))
    return config


def _refusal(database: Database, code: ErrorCode, message: str) -> ServiceError:
    return ServiceError(code, message, measured=version_of(database), limit=newest_version())


def _has_ledger(connection: Connection) -> bool:
    return sa.inspect(connection).has_table(tables.ledger.name)
