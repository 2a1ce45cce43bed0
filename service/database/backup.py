"""A whole copy of the database in one file, made while the service runs, and brought back into an empty one.

SQLite's own online backup; for PostgreSQL `pg_dump` and `pg_restore`, which must be installed beside the program.
"""

import os
import shutil
import sqlite3
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path

import sqlalchemy as sa

from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.whole_file import whole_file


def back_up(database: Database, file: Path) -> None:
    """Write one consistent moment of the database to a file that does not exist; ServiceError BACKUP_REFUSED.

    The file is its owner's alone; an unfinished one never has the name, and goes away.
    """
    if file.exists():
        raise _refused(f"{file} exists")
    try:
        with whole_file(file) as part:
            part.touch(mode=0o600)
            if _is_sqlite(database):
                _copy(Path(str(database.reader.url.database)), part)
            else:
                _run("pg_dump", database, "--format=custom", f"--file={part}")
    except OSError as error:
        raise _refused(f"{file} cannot be written ({error.strerror})") from error


def check_backup(file: Path, database_url: str) -> None:
    """ServiceError BACKUP_REFUSED where the file is no backup: asked before a database is opened, which makes it."""
    if not file.is_file():
        raise _refused(f"there is no file {file}")
    if sa.make_url(database_url).get_backend_name() == "sqlite":
        with _whole_backup(file):
            return


def restore(database: Database, file: Path) -> None:
    """Bring a backup into a database without tables; ServiceError BACKUP_REFUSED, and then nothing has changed.

    What is restored must hold a record: an empty file is a database without tables to SQLite.
    """
    with database.read() as connection:
        if sa.inspect(connection).get_table_names():
            raise _refused("the database is not empty")
    if _is_sqlite(database):
        target = Path(str(database.writer.url.database))
        database.close()
        _copy(file, target)
    else:
        _run("pg_restore", database, "--no-owner", "--single-transaction", "--exit-on-error", str(file))


def _is_sqlite(database: Database) -> bool:
    return database.writer.dialect.name == "sqlite"


def _copy(source: Path, target: Path) -> None:
    with _whole_backup(source) as here, closing(sqlite3.connect(target)) as there:
        here.backup(there)


@contextmanager
def _whole_backup(source: Path) -> Iterator[sqlite3.Connection]:
    try:
        with closing(sqlite3.connect(f"{source.absolute().as_uri()}?mode=ro", uri=True)) as here:
            _check_whole(here, source)
            yield here
    except sqlite3.Error as error:
        raise _refused(f"{source} cannot be copied: {error}") from error


def _check_whole(connection: sqlite3.Connection, source: Path) -> None:
    (found,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    if found != "ok":
        raise _refused(f"{source} is damaged: {found}")
    (versions,) = connection.execute("SELECT count(*) FROM sqlite_master WHERE name = 'alembic_version'").fetchone()
    if not versions:
        raise _refused(f"{source} holds no record")


def _run(program: str, database: Database, *arguments: str) -> None:
    """The password goes by the environment: arguments are visible to every user of the machine."""
    if shutil.which(program) is None:
        raise _refused(f"{program} is not installed")
    url = database.writer.url
    address = url.set(drivername="postgresql", password=None).render_as_string()
    secret = {"PGPASSWORD": str(url.password)} if url.password else {}
    command: Sequence[str] = (program, f"--dbname={address}", "--no-password", *arguments)
    ended = subprocess.run(command, env=os.environ | secret, capture_output=True, text=True)  # noqa: S603  # no shell
    if ended.returncode != 0:
        raise _refused(f"{program}: {' '.join(ended.stderr.split())}")


def _refused(message: str) -> ServiceError:
    return ServiceError(ErrorCode.BACKUP_REFUSED, message)
