"""The event store: versions, staleness, artefacts that commit with their event, keys that have one effect."""

import threading
from dataclasses import replace

import pytest
import sqlalchemy as sa
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from sqlalchemy.exc import IntegrityError

from service.auth.permissions import Role
from service.cases import store
from service.cases.attempts import list_attempts, record_attempt
from service.cases.idempotency import Intent, KeptAnswer, intent_of, keep_answer, kept_answer
from service.cases.records import ArtefactKind, NewArtefact, NewAttempt, NewCase, NewEvent, NewVerdict
from service.database import tables
from service.errors import ErrorCode, ServiceError
from service.ledger.keys import Signer, Verifier

EVENT = NewEvent("noted", None, "case_open", {"state": "case_open"}, {})


@pytest.fixture
def surgeon(users):
    return users.add("anna", Role.SURGEON, "correct horse", "2468")


@pytest.fixture
def case(database, surgeon):
    new = NewCase("case-1", "room-1", "P1", "1.2.3", surgeon.id, "0" * 64, {"guide": "g"}, {"L4 left": {"depth": 1}})
    with database.write() as connection:
        store.open_case(connection, new, EVENT)
    return new


def _append(database, event=EVENT, **options):
    options.setdefault("expected_version", None)
    with database.write() as connection:
        return store.append(connection, "case-1", event, **options)


def test_an_event_that_changes_the_state_raises_the_version_and_a_note_does_not(database, case):
    assert _append(database, expected_version=1).version == 2
    note = _append(database, replace(EVENT, changes_state=False))
    assert (note.sequence, note.version) == (3, 2)
    assert _append(database, expected_version=2).version == 4


def test_a_stale_version_is_refused_with_both_versions_and_changes_nothing(database, case):
    _append(database, expected_version=1)
    with pytest.raises(ServiceError) as refusal:
        _append(database, expected_version=1)
    assert (refusal.value.code, refusal.value.measured, refusal.value.limit) == (ErrorCode.VERSION_STALE, 2, 1)
    with database.read() as connection:
        assert store.newest_event(connection, "case-1").sequence == 2


def test_of_eight_writers_on_one_version_one_wins(database, case):
    outcomes = []

    def write() -> None:
        try:
            outcomes.append(_append(database, expected_version=1).version)
        except ServiceError as error:
            outcomes.append(error.code)

    threads = [threading.Thread(target=write) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(map(str, outcomes)) == ["2"] + [ErrorCode.VERSION_STALE] * 7


def test_an_unknown_case_is_refused(database):
    with pytest.raises(ServiceError) as refusal:
        _append(database)
    assert refusal.value.code == ErrorCode.CASE_UNKNOWN


def test_a_room_has_one_open_case_until_it_is_over(database, case, surgeon):
    second = replace(case, id="case-2")
    with pytest.raises(ServiceError) as refusal, database.write() as connection:
        store.open_case(connection, second, EVENT)
    assert refusal.value.code == ErrorCode.CASE_OPEN
    with database.write() as connection:
        store.open_case(connection, replace(case, id="case-3", room="room-2"), EVENT)
    _append(database, replace(EVENT, state="aborted"))
    with database.write() as connection:
        store.open_case(connection, second, EVENT)
        assert store.open_case_of(connection, "room-1") == "case-2"


def test_an_artefact_that_cannot_be_stored_takes_its_event_with_it(database, case):
    target = NewArtefact(ArtefactKind.TARGET, "t1", ("r1",), {"u": 1.0}, {})
    _append(database, artefacts=[target])
    with pytest.raises(IntegrityError):
        _append(database, artefacts=[replace(target, id="t2"), target])
    with database.read() as connection:
        assert store.newest_event(connection, "case-1").sequence == 2
        stored = store.artefacts_of(connection, ArtefactKind.TARGET, "case-1")
    assert [(one.id, one.sequence, one.made_from, one.content) for one in stored] == [("t1", 2, ("r1",), {"u": 1.0})]


@pytest.mark.hazard("H14")
def test_a_permit_is_used_once(database, case, surgeon):
    permit = NewArtefact(ArtefactKind.PERMIT, "p1", (), {}, {"approved_by": surgeon.id})
    use = NewArtefact(ArtefactKind.PERMIT_USE, "p1", ("p1",), {}, {})
    _append(database, artefacts=[permit])
    _append(database, artefacts=[use])
    with pytest.raises(IntegrityError):
        _append(database, artefacts=[use])
    with pytest.raises(IntegrityError):
        _append(database, artefacts=[replace(use, id="never approved")])


def test_a_trajectory_comes_back_to_the_byte(database, case):
    motion = NewArtefact(ArtefactKind.MOTION, "m1", (), {}, {"trajectory": bytes(range(256))})
    _append(database, artefacts=[motion])
    with database.read() as connection:
        found = store.read_artefact(connection, ArtefactKind.MOTION, "m1")
    assert found.columns["trajectory"] == bytes(range(256))


def test_a_number_that_is_not_finite_is_kept_as_text(database, case):
    _append(database, replace(EVENT, data={"rms": float("nan"), "list": [float("-inf"), 1.5]}))
    with database.read() as connection:
        assert store.newest_event(connection, "case-1").data == {"rms": "nan", "list": ["-inf", 1.5]}


def _intent(user_id: str, key: str, body: bytes) -> Intent:
    key_of_all = Ed25519PrivateKey.from_private_bytes(bytes(32))
    return intent_of(Signer(key_of_all, Verifier(key_of_all.public_key())), user_id, key, "POST", "/x", body)


@pytest.mark.hazard("H14")
def test_64_equal_requests_have_one_effect_and_one_answer(database, case):
    meant = _intent("anna", "key-1", b"{}")
    answers = []

    def post() -> None:
        with database.write() as connection:
            answer = kept_answer(connection, meant)
            if answer is None:
                event = store.append(connection, "case-1", EVENT, expected_version=1)
                answer = KeptAnswer(200, {"sequence": event.sequence}, event.version)
                keep_answer(connection, meant, answer)
            answers.append(answer)

    threads = [threading.Thread(target=post) for _ in range(64)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == [KeptAnswer(200, {"sequence": 2}, 2)] * 64
    with database.read() as connection:
        assert len(store.events_after(connection, "case-1")) == 2


def test_a_key_for_another_body_is_refused_and_another_users_key_is_another_key(database):
    with database.write() as connection:
        keep_answer(connection, _intent("anna", "k", b"1"), KeptAnswer(200, {}, 1))
    with database.read() as connection:
        with pytest.raises(ServiceError) as refusal:
            kept_answer(connection, _intent("anna", "k", b"2"))
        assert kept_answer(connection, _intent("ben", "k", b"2")) is None
    assert refusal.value.code == ErrorCode.IDEMPOTENCY_KEY_REUSED


def test_a_refused_attempt_keeps_every_verdict(database, case):
    verdicts = (
        NewVerdict("residual_bounded", "H06", False, 1.5, 1.0, "px", "too high"),
        NewVerdict("arm_at_rest", "H04", True, True, True, "", "at rest"),
        NewVerdict("feedback_advances", "H21", False, float("nan"), "advancing", "s", "no clock"),
    )
    attempt = NewAttempt("case-1", None, "move_approved", False, "interlock", "refused", "target_chosen", verdicts)
    with database.write() as connection:
        record_attempt(connection, attempt)
    with database.read() as connection:
        (stored,) = list_attempts(connection, "case-1")
    assert [one["measured"] for one in stored["verdicts"]] == [1.5, True, "nan"]
    assert [one["passed"] for one in stored["verdicts"]] == [False, True, False]
    assert (stored["accepted"], stored["code"]) == (False, "interlock")


def test_an_event_of_nobody_known_is_refused(database, case):
    with pytest.raises(IntegrityError):
        _append(database, replace(EVENT, user_id="nobody"))
    with database.read() as connection:
        assert connection.execute(sa.select(sa.func.count()).select_from(tables.events)).scalar() == 1
