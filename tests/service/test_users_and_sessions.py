"""Users, sessions, lock-out: the clock is injected, the database is real."""

from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from queue import SimpleQueue
from threading import Barrier, BrokenBarrierError

import pytest
import sqlalchemy as sa
from argon2 import PasswordHasher

from service.auth import sessions as sessions_module
from service.auth.door import MOST_AT_THE_DOOR, Door
from service.auth.permissions import Role
from service.auth.proofs import Proofs
from service.auth.session import SessionStatus
from service.auth.sessions import SessionStore
from service.auth.users import UserStore
from service.database import tables
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.settings import SessionSettings
from tests.waiting import until

_RULES = SessionSettings(lifetime_s=1000, idle_lock_s=100, wrong_answers=3, lock_out_s=60)


class Clock:
    """Wall-clock seconds that a test moves."""

    def __init__(self) -> None:
        self.now_s = 1_000_000.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def anna(users):
    return users.add("anna", Role.SURGEON, "correct horse", "2468")


@pytest.fixture
def sessions(database, clock):
    return SessionStore(database, _RULES, clock)


@pytest.fixture
def proofs(database, users, clock):
    return Proofs(database, users, _RULES, clock)


def _code(call, *arguments) -> str:
    with pytest.raises(ServiceError) as refusal:
        call(*arguments)
    return refusal.value.code


@pytest.mark.parametrize(
    ("name", "password", "pin"),
    [
        ("", "correct horse", "2468"),
        ("an na", "correct horse", "2468"),
        ("anna", "short", "2468"),
        ("anna", "x" * 257, "2468"),
        ("anna", "correct horse", "12"),
        ("anna", "correct horse", "abcd"),
        ("anna", "correct horse", "٢٤٦٨"),
    ],
)
def test_a_user_that_breaks_a_rule_is_refused(users, name, password, pin):
    assert _code(users.add, name, Role.SURGEON, password, pin) == ErrorCode.USER_REFUSED


def test_a_name_is_taken_once(users, anna):
    assert _code(users.add, "anna", Role.AUDITOR, "correct horse", "2468") == ErrorCode.USER_EXISTS


@pytest.mark.hazard("H27")
def test_neither_password_nor_pin_nor_token_is_in_the_database(database, users, anna, sessions, tmp_path):
    token, _ = sessions.create(anna)
    with database.read() as connection:
        rows = repr([list(connection.execute(sa.select(table))) for table in tables.metadata.sorted_tables]).encode()
    database.close()
    content = b"".join(file.read_bytes() for file in tmp_path.iterdir())
    assert b"anna" in rows
    for secret in ("correct horse", token):
        assert secret.encode() not in rows + content


def test_password_and_pin_are_checked(proofs, sessions, anna):
    assert proofs.sign_in("anna", "correct horse") == anna
    _, session = sessions.create(anna)
    proofs.confirm_pin(session, "2468")
    assert _code(proofs.sign_in, "anna", "wrong") == ErrorCode.SIGN_IN_REFUSED
    assert _code(proofs.sign_in, "nobody", "correct horse") == ErrorCode.SIGN_IN_REFUSED
    assert _code(proofs.confirm_pin, session, "1357") == ErrorCode.PIN_REFUSED


@pytest.mark.hazard("H27")
def test_the_last_wrong_answer_locks_out_the_right_one_too_until_the_time_is_over(proofs, anna, clock):
    codes = [_code(proofs.sign_in, "anna", "wrong") for _ in range(3)]
    assert codes == [ErrorCode.SIGN_IN_REFUSED] * 3
    assert _code(proofs.sign_in, "anna", "correct horse") == ErrorCode.LOCKED_OUT
    clock.now_s += 61
    assert proofs.sign_in("anna", "correct horse") == anna


class _Together(PasswordHasher):
    """Answers that come at once are compared at once, if they are let; a real hash takes long enough for that."""

    def __init__(self, answers: int) -> None:
        super().__init__(time_cost=1, memory_cost=8, parallelism=1)
        self._all_here = Barrier(answers)

    def verify(self, *given):
        with suppress(BrokenBarrierError):
            self._all_here.wait(0.3)
        return super().verify(*given)


@pytest.mark.hazard("H27")
@pytest.mark.parametrize("by", ["password", "pin", "pin of a session"])
def test_of_wrong_answers_that_come_at_once_no_more_are_compared_than_lock_out(database, sessions, anna, clock, by):
    proofs = Proofs(database, UserStore(database, _Together(6)), _RULES, clock)
    _, session = sessions.create(anna)
    ways = {
        "password": lambda: proofs.sign_in("anna", "wrong"),
        "pin": lambda: proofs.sign_in_with_pin("anna", "0000"),
        "pin of a session": lambda: proofs.confirm_pin(session, "0000"),
    }
    with ThreadPoolExecutor(6) as threads:
        codes = list(threads.map(lambda _: _code(ways[by]), range(6)))
    assert codes.count(ErrorCode.LOCKED_OUT) == 3, codes


@pytest.mark.hazard("H32")
def test_of_many_who_sign_in_at_once_few_wait_and_the_others_are_told_at_once():
    door, refused = Door(), SimpleQueue()

    def knock() -> bool:
        try:
            with door.turn():
                return True
        except ServiceError as refusal:
            refused.put(refusal.code)
            return False

    with ThreadPoolExecutor(20) as threads:
        with door.turn():
            knocking = [threads.submit(knock) for _ in range(20)]
            codes = {refused.get(timeout=10) for _ in range(20 - (MOST_AT_THE_DOOR - 1))}
        let_in = [one.result() for one in knocking].count(True)
    assert codes == {ErrorCode.SIGN_IN_BUSY}
    assert let_in == MOST_AT_THE_DOOR - 1
    assert knock()


def test_a_lock_out_survives_a_restart(database, users, proofs, anna, clock):
    for _ in range(3):
        _code(proofs.sign_in, "anna", "wrong")
    restarted = Proofs(database, users, _RULES, clock)
    assert _code(restarted.sign_in, "anna", "correct horse") == ErrorCode.LOCKED_OUT


def test_wrong_pins_lock_the_pin_of_that_user_only(proofs, sessions, users, anna):
    _, session = sessions.create(anna)
    _, other = sessions.create(users.add("ben", Role.SURGEON, "correct horse", "1111"))
    for _ in range(3):
        _code(proofs.confirm_pin, session, "0000")
    assert _code(proofs.confirm_pin, session, "2468") == ErrorCode.LOCKED_OUT
    proofs.confirm_pin(other, "1111")


def test_right_answers_in_between_forgive_wrong_ones(proofs, anna):
    for _ in range(4):
        _code(proofs.sign_in, "anna", "wrong")
        proofs.sign_in("anna", "correct horse")


def test_wrong_answers_are_in_the_audit(database, proofs, anna):
    _code(proofs.sign_in, "anna", "wrong")
    with database.read() as connection:
        kinds = connection.execute(sa.select(tables.audit_events.c.kind)).scalars().all()
    assert kinds == ["user_added", "wrong_answer"]


def test_a_session_locks_after_a_pause_and_expires_at_its_end(sessions, anna, clock):
    token, session = sessions.create(anna)
    clock.now_s += 90
    assert sessions.find(token).status is SessionStatus.ACTIVE
    clock.now_s += 90  # 180 s after the sign-in, 90 s after the last use
    assert sessions.find(token).status is SessionStatus.ACTIVE
    clock.now_s += 101
    assert sessions.find(token).status is SessionStatus.LOCKED
    sessions.unlock(session)
    assert sessions.find(token).status is SessionStatus.ACTIVE
    clock.now_s += 1000
    assert sessions.find(token).status is SessionStatus.EXPIRED


@pytest.mark.hazard("H23")
@pytest.mark.parametrize("pause_s", [101, 1001])
@pytest.mark.parametrize("back_s", [150, 31_536_000])
def test_a_clock_that_is_put_back_gives_no_session_back(sessions, anna, clock, pause_s, back_s):
    token, session = sessions.create(anna)
    clock.now_s += 40
    assert sessions.find(token).status is SessionStatus.ACTIVE
    clock.now_s += pause_s
    assert sessions.find(token).status is not SessionStatus.ACTIVE
    clock.now_s -= pause_s + back_s
    assert sessions.find(token).status is SessionStatus.LOCKED
    sessions.unlock(session)
    assert sessions.find(token).status is SessionStatus.ACTIVE


@pytest.mark.hazard("H23")
def test_a_lock_out_begins_anew_when_the_clock_is_put_back_and_lasts_no_year(proofs, anna, clock):
    for _ in range(3):
        _code(proofs.sign_in, "anna", "wrong")
    clock.now_s -= 59  # s, of the 60 that it lasts
    assert _code(proofs.sign_in, "anna", "correct horse") == ErrorCode.LOCKED_OUT
    clock.now_s -= 31_536_000
    assert _code(proofs.sign_in, "anna", "correct horse") == ErrorCode.LOCKED_OUT
    clock.now_s += 59
    assert _code(proofs.sign_in, "anna", "correct horse") == ErrorCode.LOCKED_OUT
    clock.now_s += 2
    assert proofs.sign_in("anna", "correct horse") == anna


def test_looking_at_a_locked_session_does_not_keep_it_from_being_locked(sessions, anna, clock):
    token, _ = sessions.create(anna)
    for _ in range(3):
        clock.now_s += 101
        assert sessions.find(token).status is SessionStatus.LOCKED


def test_a_full_disk_signs_nobody_out(database, sessions, anna, clock, monkeypatch):
    token, session = sessions.create(anna)
    clock.now_s += 50

    def full(_database: Database) -> None:
        raise ServiceError(ErrorCode.DISK_FULL, "the disk is full")

    monkeypatch.setattr(Database, "write", full)
    assert sessions.find(token) == session
    sessions.close()


def test_a_use_counts_at_once_and_waits_for_no_other_writer(database, sessions, anna, clock):
    token, session = sessions.create(anna)
    with database.write():  # as a backup holds the turn, or another room
        for _ in range(3):
            clock.now_s += 60
            assert sessions.find(token) == session
    restarted = SessionStore(database, _RULES, clock)
    until(lambda: restarted.find(token) == session)  # written by now, by who noted it
    sessions.close()


def test_locked_and_expired_sessions_are_remembered_for_the_stop_and_revoked_ones_are_not(sessions, anna, clock):
    token, session = sessions.create(anna)
    sessions.lock(session)
    clock.now_s += 5000
    assert replace(sessions.remembered(token), status=session.status) == session
    sessions.revoke(token)
    assert sessions.remembered(token) is None
    assert sessions.find(token) is None


def test_sessions_outlive_the_service_and_so_does_the_stop(database, sessions, anna, clock):
    token, session = sessions.create(anna)
    restarted = SessionStore(database, _RULES, clock)
    assert restarted.find(token) == session
    assert restarted.remembered(token) == session


def test_of_sessions_that_are_over_the_newest_may_stop_and_none_that_is_not_gives_way(
    database, sessions, anna, clock, monkeypatch
):
    monkeypatch.setattr(sessions_module, "MOST_REMEMBERED", 3)
    over = []
    for _ in range(4):
        over.append(sessions.create(anna)[0])
        clock.now_s += 2000  # s, of the 1000 that a session lasts
    alive = []
    for _ in range(4):
        alive.append(sessions.create(anna)[0])
        clock.now_s += 1
    for store in (sessions, SessionStore(database, _RULES, clock)):
        assert [store.remembered(token) is not None for token in (*over, *alive)] == [False] * 4 + [True] * 4
    clock.now_s += 2000
    newest, _ = sessions.create(anna)
    for store in (sessions, SessionStore(database, _RULES, clock)):
        kept = [store.remembered(token) is not None for token in (*over, *alive, newest)]
        assert kept == [False] * 6 + [True] * 3


@pytest.mark.hazard("H27")
def test_a_disabled_user_is_out_at_once(users, sessions, proofs, anna):
    token, session = sessions.create(anna)
    users.disable("anna")
    assert sessions.find(token) is None
    assert _code(proofs.sign_in, "anna", "correct horse") == ErrorCode.SIGN_IN_REFUSED
    assert _code(proofs.confirm_pin, session, "2468") == ErrorCode.PIN_REFUSED
    assert _code(users.disable, "anna") == ErrorCode.USER_UNKNOWN
