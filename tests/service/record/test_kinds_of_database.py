"""A case goes from any kind of database to any: what is the same there is called the same, what differs is refused."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from service.archive.checking import check_file
from service.archive.exporting import export_case
from service.archive.importing import import_case
from service.cases import store
from service.cases.attempts import list_attempts
from service.conductor.case_list import listed_cases
from service.database.current import current_database
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.ledger.anchor import advance_anchor
from service.ledger.verifying import verify
from service.replay.computing import replay
from service.replay.reading import read_input
from service.settings import Settings
from tests.databases import Databases, PostgresqlDatabases, SqliteFiles
from workflow.states import State

pytestmark = pytest.mark.usefixtures("remembered_jobs")
Workstation = tuple[Database, Settings]


@pytest.fixture
def workstation(request, tmp_path) -> Callable[..., object]:
    """An open database of a kind, in a folder of its own."""

    @contextmanager
    def open_one(kind: str, name: str, case_of: Callable[..., object] | None = None) -> Iterator[Workstation]:
        folder = tmp_path / name
        folder.mkdir()
        kinds: Databases = SqliteFiles(tmp_path) if kind == "sqlite" else request.getfixturevalue("postgresql")
        with kinds.empty(folder) as address:
            if case_of is not None:
                case_of(folder, State.CLOSED, database_url=address)
            settings = Settings(data_folder=folder, database_url=address, min_free_bytes=0)
            with current_database(settings) as database:
                yield database, settings

    return open_one


def _export(database: Database, case_id: str, out: Path) -> Path:
    export_case(database, database.signer, case_id, None, out, pseudonymised=False)
    assert check_file(out, {}).findings == []
    return out


def _only_case(database: Database) -> str:
    with database.read() as connection:
        (case_id,) = {one["case_id"] for one in list_attempts(connection, None)}
    return case_id


def _figures(database: Database, case_id: str) -> list[tuple[object, object]]:
    with database.read() as connection:
        (attempt,) = list_attempts(connection, case_id)
    return [(one["measured"], one["limit"]) for one in attempt["verdicts"]]


@pytest.mark.parametrize("there", ["sqlite", "postgresql"])
@pytest.mark.parametrize("here", ["sqlite", "postgresql"])
def test_a_case_is_exported_verified_imported_and_known_again(workstation, make_site, tmp_path, there, here) -> None:
    with workstation(there, "there", make_site) as (source, settings):
        case_id = _only_case(source)
        original = _export(source, case_id, tmp_path / "original.zip")
        assert import_case(source, settings, original, {}) == (case_id, False), "its own"
        figures = _figures(source, case_id)
        with workstation(here, "here") as (target, elsewhere):
            assert import_case(target, elsewhere, original, {}) == (case_id, True)
            assert import_case(target, elsewhere, original, {}) == (case_id, False), "the same, again"
            assert _figures(target, case_id) == [tuple(map(_nearly, pair)) for pair in figures]
            advance_anchor(target, elsewhere.anchor_file, target.signer)
            found = verify(target, {target.signer.verifier.name: target.signer.verifier}, elsewhere.anchor_file)
            assert found.findings == []
            with target.read() as connection:
                assert replay(read_input(connection, case_id, elsewhere)).differences == ()
                assert [one.id for one in listed_cases(connection, 10, None)] == [case_id]
                assert store.whole_id(connection, case_id[:8]) == case_id
            back = _export(target, case_id, tmp_path / "back.zip")
        assert import_case(source, settings, back, {}) == (case_id, False), "the same, come back"


def _nearly(value: object) -> object:
    """SQLite's neighbour of a number is no other figure."""
    return pytest.approx(value, rel=1e-15, abs=0.0) if isinstance(value, float) else value


@pytest.mark.parametrize("here", ["sqlite", "postgresql"])
def test_another_figure_of_a_verdict_is_another_case(workstation, make_site, tmp_path, here) -> None:
    with workstation("sqlite", "there", make_site) as (source, _):
        original = _export(source, _only_case(source), tmp_path / "original.zip")
    kinds: Databases
    with workstation(here, "here") as (target, elsewhere):
        import_case(target, elsewhere, original, {})
        address = elsewhere.database_url
        kinds = SqliteFiles(tmp_path) if here == "sqlite" else PostgresqlDatabases(address)
        target.close()
        with kinds.attack(address) as attacker:
            attacker.execute("UPDATE verdicts SET measured = '0.2501' WHERE code = 'interlock_0'")
        with pytest.raises(ServiceError) as refused:
            import_case(target, elsewhere, original, {})
    assert (refused.value.code, refused.value.measured) == (ErrorCode.CASE_DIFFERS, 1)
