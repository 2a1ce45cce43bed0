"""Keep a filled database of today's schema as test data, for both kinds of database: run once for each release.

`python -m tests.service.released.keep` writes `<revision>.<dialect>.sql` and the public key of its checkpoints.
"""

import sqlite3
import subprocess
import tempfile
from contextlib import closing
from pathlib import Path

from alembic.migration import MigrationContext

from service.database.engines import open_database
from service.database.migrate import migrate
from service.ledger.keys import Signer, signing_key
from tests.databases import Databases, PostgresqlDatabases, SqliteFiles, file_of
from tests.postgresql_server import PROGRAMS, postgresql_server
from tests.service.ledger.conftest import fill

FOLDER = Path(__file__).parent


def main() -> None:
    """Fill and dump."""
    with tempfile.TemporaryDirectory() as name, postgresql_server() as server:
        signer = signing_key(Path(name) / "signing.key")
        for databases in (SqliteFiles(Path(name)), PostgresqlDatabases(server)):
            revision = _keep(databases, signer, Path(name))
        (FOLDER / f"{revision}.pem").write_text(signer.verifier.pem)


def _keep(databases: Databases, signer: Signer, folder: Path) -> str:
    with databases.empty(folder) as address:
        with closing(open_database(address, signer)) as database:
            migrate(database)
            fill(database)
            with database.read() as connection:
                revision = str(MigrationContext.configure(connection).get_current_revision())
        (FOLDER / f"{revision}.{databases.dialect}.sql").write_text(dumped(databases, address))
    return revision


def dumped(databases: Databases, address: str) -> str:
    """The database as statements that make it again."""
    if databases.dialect == "sqlite":
        with closing(sqlite3.connect(file_of(address))) as connection:
            return "\n".join(connection.iterdump()) + "\n"
    program = PROGRAMS[-1].parent / "pg_dump"
    command = [program, "--inserts", "--no-owner", "--no-comments", address]
    dump = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return "".join(line for line in dump.splitlines(keepends=True) if not line.startswith("\\"))  # psql's own


if __name__ == "__main__":
    main()
