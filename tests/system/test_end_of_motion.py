"""Between the guard's report of an arrival and its record: nothing starts, no stop is lost, and guard and case agree.

The record is held up by another writer of the database, as a backup or a slow disk would.
"""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager

import pytest

from coaxial_client import Case, Refused
from service.database.engines import open_database
from tests.system.service_process import PIN, Service
from tests.waiting import until

_HELD_UP_S = 1.0
_MOVE_LINEAR = 3


@contextmanager
def _nothing_is_recorded(service: Service) -> Iterator[None]:
    with closing(open_database(service.database_url)) as database, database.write():
        yield


@pytest.fixture
def arrived(case: Case, service: Service, lift: Callable[..., dict]) -> Callable[[Callable[[str], object]], list[str]]:
    """Does something in a room whose arm has arrived by the guard's word, and whose case has it moving still."""

    def do(act: Callable[[str], object]) -> list[str]:
        for _ in range(4):  # a crowded machine may lose the hold; then the hand presses again
            refused = _act_at_the_end(case, service, case.approve(lift(10.0), PIN), act)
            if refused is not None:
                return refused
            if case.wait_for("safe_hold", "case_open")["state"] == "safe_hold":
                case.command("acknowledged", guide="empty")
        pytest.fail("the machine is too busy to hold a button for a second")

    return do


def _act_at_the_end(case: Case, service: Service, permit: str, act: Callable[[str], object]) -> list[str] | None:
    """The codes that the act was refused with; None if the motion did not come to its end."""
    refused: list[str] = []

    def try_to() -> None:
        try:
            act(permit)
        except Refused as refusal:
            refused.append(refusal.code)

    acting = threading.Thread(target=try_to)
    with case.hold(permit) as hold:
        until(lambda: hold.is_over or case.status()["arm"]["phase"] == "moving")
        with _nothing_is_recorded(service):
            until(lambda: case.status()["arm"]["phase"] in ("idle", "held"))
            status = case.status()
            if (status["arm"]["phase"], status["state"]) != ("idle", "moving"):
                return None
            acting.start()
            time.sleep(_HELD_UP_S)
    acting.join(20.0)
    assert not acting.is_alive()
    return refused


def _agree(case: Case) -> str:
    """The state of the case, once the guard's lock is what the case says."""
    until(lambda: (case.status()["arm"]["phase"] == "held") == (case.status()["state"] == "safe_hold"), 3.0)
    return case.status()["state"]


@pytest.mark.hazard("H18")
def test_a_stop_in_between_holds_guard_and_case(case, arrived) -> None:
    assert arrived(lambda _: case.stop()) == []
    case.wait_for("safe_hold")
    assert _agree(case) == "safe_hold"
    case.command("acknowledged", guide="empty")
    assert _agree(case) == "case_open"


@pytest.mark.hazard("H04")
def test_a_statement_in_between_that_stops_the_arm_holds_guard_and_case(case, arrived) -> None:
    assert arrived(lambda _: case.command("patient-moved", what="turned")) == []
    assert _agree(case) == "safe_hold"
    case.command("acknowledged", guide="empty")
    assert _agree(case) == "case_open"


@pytest.mark.hazard("H15")
def test_control_asked_for_in_between_leaves_guard_and_case_agreeing(case, arrived) -> None:
    arrived(lambda _: case.take_lease("another hand"))
    _agree(case)


@pytest.mark.hazard("H14")
def test_a_second_hold_in_between_starts_nothing(case, arrived, controller) -> None:
    newest = controller.wire()[-1].number

    def press_again(permit: str) -> None:
        with case.hold(permit) as second:
            second.wait(10.0)

    assert arrived(press_again) in (
        ["arm_moving"],
        ["missing"],
    )  # the latter once the arrival is in: its permit is used
    assert _agree(case) == "case_open"
    assert len([record for record in controller.wire(newest) if record.command == _MOVE_LINEAR]) == 1
