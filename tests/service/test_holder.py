"""How long a session whose holder moves the arm may go unconfirmed (H27); what ends it is asked of the whole system."""

import asyncio
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace
from typing import Any

import pytest

from service.auth.permissions import Role
from service.auth.session import SessionStatus
from service.errors import ErrorCode, ServiceError
from service.motion import holder

_SURGEON = SimpleNamespace(status=SessionStatus.ACTIVE, role=Role.SURGEON)
_AUDITOR = SimpleNamespace(status=SessionStatus.ACTIVE, role=Role.AUDITOR)


class Sessions:
    """Answers in turn, the last one for ever; a number is a wait in seconds before the next of them."""

    def __init__(self, *answers: Any) -> None:
        self._answers = list(answers)
        self.asked = 0

    def look(self, _token: str) -> Any:
        self.asked += 1
        answer = self._answers.pop(0) if len(self._answers) > 1 else self._answers[0]
        if isinstance(answer, float):
            time.sleep(answer)
            return self.look(_token)
        if isinstance(answer, Exception):
            raise answer
        return answer


@pytest.fixture(autouse=True)
def asking(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A thread that no earlier test's database keeps waiting."""
    with ThreadPoolExecutor(1) as threads:
        monkeypatch.setattr(holder, "_asking", threads)
        yield


def _ended(sessions: Sessions) -> tuple[ServiceError, float]:
    began_s = time.monotonic()
    return asyncio.run(holder.session_over(sessions, "token")), time.monotonic() - began_s


def test_a_session_that_ends_is_noticed_when_it_is_next_asked_for() -> None:
    sessions = Sessions(_SURGEON, _SURGEON, _AUDITOR)
    assert _ended(sessions)[0].code == ErrorCode.PERMISSION_MISSING
    assert sessions.asked == 3


@pytest.mark.hazard("H27")
@pytest.mark.parametrize("silence", [(ServiceError(ErrorCode.DATABASE_FAULT, "away"),), (1.6, _SURGEON)])
def test_a_database_that_says_nothing_of_the_session_ends_the_hold(silence) -> None:
    error, after_s = _ended(Sessions(_SURGEON, *silence))
    assert (error.code, error.limit) == (ErrorCode.DATABASE_BUSY, 1.0)
    assert error.measured == pytest.approx(after_s, abs=0.3)  # s, of which the first answer and a busy machine


def test_a_database_that_pauses_for_less_than_that_ends_nothing() -> None:
    fault = ServiceError(ErrorCode.DATABASE_FAULT, "away")
    error, _ = _ended(Sessions(_SURGEON, fault, 0.3, _SURGEON, 0.6, _SURGEON, _AUDITOR))
    assert error.code == ErrorCode.PERMISSION_MISSING
