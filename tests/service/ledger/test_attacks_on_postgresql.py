"""H26 on PostgreSQL: somebody who may switch the triggers off changes nothing that is not found."""

from itertools import count

import pytest
import sqlalchemy as sa

from service.database.engines import open_database
from service.database.migrate import migrate
from service.ledger.anchor import advance_anchor
from service.ledger.keys import signing_key
from service.ledger.verifying import verify

_numbers = count()


@pytest.fixture(scope="module")
def kept(postgresql_address, fill_record, tmp_path_factory):
    """A database to copy, with its key and anchor."""
    folder = tmp_path_factory.mktemp("postgresql")
    signer = signing_key(folder / "signing.key")
    _execute(postgresql_address, "CREATE DATABASE kept")
    database = open_database(_named(postgresql_address, "kept"), signer)
    migrate(database)
    fill_record(database)
    advance_anchor(database, folder / "head.json", signer)
    database.close()
    return postgresql_address, signer, folder / "head.json"


@pytest.fixture
def wheres(kept):
    """Places that a verification names after these statements."""
    address, signer, anchor = kept

    def after(*statements: str) -> set[str]:
        name = f"attacked_{next(_numbers)}"
        _execute(address, f"CREATE DATABASE {name} TEMPLATE kept")
        _execute(_named(address, name), "SET session_replication_role = replica", *statements)
        database = open_database(_named(address, name))
        try:
            found = verify(database, {signer.verifier.name: signer.verifier}, anchor)
        finally:
            database.close()
        return {one.where for one in found.findings}

    return after


def _named(address: str, name: str) -> str:
    return address.rpartition("/")[0] + f"/{name}"


def _execute(address: str, *statements: str) -> None:
    engine = sa.create_engine(address.replace("postgresql:", "postgresql+psycopg:"), isolation_level="AUTOCOMMIT")
    try:
        with engine.connect() as connection:
            for statement in statements:
                connection.exec_driver_sql(statement)
    finally:
        engine.dispose()


_LAST_AUDIT = "DELETE FROM audit_events WHERE id = (SELECT max(id) FROM audit_events)"


@pytest.mark.parametrize(
    ("statements", "places"),
    [
        ([], set()),
        (["UPDATE verdicts SET measured = '12.3456788' WHERE id = 1"], {"verdicts 1"}),
        (["UPDATE attempts SET accepted = false WHERE id = 2"], {"attempts 2"}),
        (["UPDATE image_bytes SET content = content || 'x'::bytea WHERE content = 'image 1'"], {"image_bytes"}),
        (["UPDATE cases SET devices = '{} ' WHERE id = 'case-2'"], {"cases case-2"}),
        (["DELETE FROM events WHERE case_id = 'case-1' AND sequence = 4"], {"events case-1/4"}),
        (["INSERT INTO audit_events VALUES (999, 'forged', NULL, '{}', '')"], {"audit_events 999"}),
        (["DELETE FROM ledger WHERE sequence = 7"], {"entry 7", "entry 8"}),
        (["UPDATE ledger SET actor = 'forged' WHERE sequence = 7"], {"entry 7"}),
        (["DELETE FROM ledger WHERE sequence = (SELECT max(sequence) FROM ledger)", _LAST_AUDIT], {"anchor"}),
        (["UPDATE checkpoints SET signature = reverse(signature) WHERE sequence = 1"], {"checkpoint 1"}),
        (["TRUNCATE ledger, checkpoints"], {"ledger", "anchor"}),
    ],
)
def test_what_was_done_is_found_and_placed(wheres, statements, places):
    found = wheres(*statements)
    assert bool(found) is bool(statements)
    if places == {"image_bytes"}:
        assert {where.split()[0] for where in found} == places
    else:
        assert places <= found


@pytest.mark.parametrize("table", ["ledger", "checkpoints"])
@pytest.mark.parametrize("change", ["UPDATE {} SET sequence = 0", "DELETE FROM {}", "TRUNCATE {} CASCADE"])
def test_the_ledger_refuses_every_change(kept, table, change):
    with pytest.raises(sa.exc.DBAPIError, match="append-only"):
        _execute(_named(kept[0], "kept"), change.format(table))
