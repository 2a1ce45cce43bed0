"""The control lease: a fencing token that only grows, so that a holder of yesterday is seen (H15)."""

import threading

import pytest

from service.auth.lease import check_lease, lease_of, take_lease
from service.auth.permissions import Role
from service.auth.sessions import SessionStore
from service.cases import store
from service.cases.records import NewCase, NewEvent
from service.errors import ErrorCode, ServiceError
from service.settings import SessionSettings


@pytest.fixture
def holders(database, users):
    sessions = SessionStore(database, SessionSettings())
    surgeon = users.add("anna", Role.SURGEON, "correct horse", "2468")
    tablets = [sessions.create(surgeon)[1] for _ in range(2)]
    case = NewCase("case-1", "room-1", "P1", "1.2.3", surgeon.id, "0" * 64, {}, {})
    with database.write() as connection:
        store.open_case(connection, case, NewEvent("case_opened", surgeon.id, "case_open", {}, {}))
    return tablets


def _check(database, session, token) -> str | None:
    with database.read() as connection:
        try:
            check_lease(lease_of(connection, "case-1"), session, token)
        except ServiceError as error:
            return error.code
    return None


def test_without_a_lease_nobody_has_control(database, holders):
    assert _check(database, holders[0], 1) == ErrorCode.LEASE_MISSING
    assert _check(database, holders[0], None) == ErrorCode.LEASE_MISSING


@pytest.mark.hazard("H15")
def test_a_take_over_fences_the_old_token_out_even_for_the_same_person(database, holders):
    first, second = holders
    with database.write() as connection:
        old = take_lease(connection, "case-1", first, "start")
    assert _check(database, first, old.fencing_token) is None
    assert _check(database, second, old.fencing_token) == ErrorCode.LEASE_LOST
    with database.write() as connection:
        new = take_lease(connection, "case-1", second, "tablet broke")
    assert new.fencing_token > old.fencing_token
    assert _check(database, first, old.fencing_token) == ErrorCode.LEASE_LOST
    assert _check(database, first, new.fencing_token) == ErrorCode.LEASE_LOST
    assert _check(database, second, new.fencing_token) is None


def test_the_same_tablet_taking_again_makes_its_old_token_void(database, holders):
    with database.write() as connection:
        old = take_lease(connection, "case-1", holders[0], "start")
        take_lease(connection, "case-1", holders[0], "again")
    assert _check(database, holders[0], old.fencing_token) == ErrorCode.LEASE_LOST


@pytest.mark.hazard("H15")
def test_tokens_taken_at_once_are_all_different(database, holders):
    tokens = []

    def take(session) -> None:
        with database.write() as connection:
            tokens.append(take_lease(connection, "case-1", session, "race").fencing_token)

    threads = [threading.Thread(target=take, args=(holders[index % 2],)) for index in range(16)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(tokens) == list(range(1, 17))
    with database.read() as connection:
        assert lease_of(connection, "case-1").fencing_token == 16


def test_a_refusal_shows_no_figures_that_would_pass(database, holders):
    """The newest token in another hand: the tokens are not what differs."""
    with database.write() as connection:
        lease = take_lease(connection, "case-1", holders[0], "start")
    with pytest.raises(ServiceError) as refused:
        check_lease(lease, holders[1], lease.fencing_token)
    assert (refused.value.measured, refused.value.limit) == (None, None)
