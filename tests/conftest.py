"""Which database the tests use: `pytest --database postgresql` runs them all on a server of their own."""

import os
from collections.abc import Iterator

import pytest
from hypothesis import settings

from tests.certificates import Certificate, make_certificate
from tests.databases import Databases, PostgresqlDatabases, SqliteFiles
from tests.postgresql_server import PROGRAMS, postgresql_server

# The same examples in every run, so that a change is refused for what it does and not for its luck; `make explore`
# looks for new ones. A loaded machine is no reason to fail.
settings.register_profile("same", derandomize=True, deadline=None)
settings.register_profile("explore", max_examples=2000, deadline=None, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))


def pytest_addoption(parser: pytest.Parser) -> None:
    """The choice of the database."""
    parser.addoption("--database", choices=["sqlite", "postgresql"], default="sqlite", help="what records are kept in")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """What is about SQLite itself has nothing to say on another database."""
    if config.getoption("--database") == "sqlite":
        return
    for item in items:
        if item.get_closest_marker("sqlite"):
            item.add_marker(pytest.mark.skip(reason="about SQLite itself"))


@pytest.fixture(scope="session")
def postgresql() -> Iterator[Databases]:
    """Databases of a PostgreSQL server, started for the session."""
    if not PROGRAMS:
        pytest.skip("needs a server: apt-get install postgresql")
    with postgresql_server() as address:
        yield PostgresqlDatabases(address)


@pytest.fixture(scope="session")
def databases(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Databases:
    """Databases of the kind that was chosen."""
    if request.config.getoption("--database") == "postgresql":
        chosen: Databases = request.getfixturevalue("postgresql")
        return chosen
    return SqliteFiles(tmp_path_factory.mktemp("migrated"))


@pytest.fixture(scope="session")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Certificate:
    """A certificate of localhost's own."""
    return make_certificate(tmp_path_factory.mktemp("tls"))
