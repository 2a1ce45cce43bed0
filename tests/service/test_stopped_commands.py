"""Before these the arm was stopped and so the guard locked, though the case moves no more: it is held (H18)."""

import pytest

from coaxial_client import Case, Refused
from service.motion.bridge import ArmBridge
from tests.service.any_state import NamedApart, Room
from workflow.states import State

pytestmark = pytest.mark.hazard("H18")


@pytest.fixture
def calm(room: Room, monkeypatch: pytest.MonkeyPatch) -> Case:
    """A case whose motion is in the record as arrived, and whose guard was last heard amid it."""
    room.put(NamedApart().to(State.MOVED).case)
    monkeypatch.setattr(ArmBridge, "is_moving", lambda _: True)
    return room.case


def _stands(case: Case) -> tuple[str, str, int]:
    status = case.status()
    return status["state"], status["held_for"], status["version"]


def test_control_taken(calm: Case) -> None:
    answer = calm.command("lease-taken", reason="another hand")
    assert answer["trigger"] == "lease_taken"
    assert _stands(calm) == ("safe_hold", "stop", answer["version"])
    assert answer["state"] == "safe_hold"


def test_control_that_is_refused(calm: Case) -> None:
    calm.version -= 1
    with pytest.raises(Refused) as caught:
        calm.take_lease("another hand")
    assert caught.value.code == "version_stale"
    assert _stands(calm)[:2] == ("safe_hold", "stop")


def test_a_statement(calm: Case) -> None:
    answer = calm.command("patient-moved", what="coughed")
    assert _stands(calm) == ("safe_hold", "stop", answer["version"])
    assert calm.status()["chain"]["image"] is None


def test_a_statement_about_another_case(calm: Case, room: Room) -> None:
    with pytest.raises(Refused):
        room.surgeon.post("/cases/no-such-case/patient-moved", {"what": "coughed"})
    assert _stands(calm)[:2] == ("safe_hold", "stop")


def test_a_case_that_the_command_holds_is_held_for_that(calm: Case) -> None:
    calm.command("sleeve-in")
    assert _stands(calm)[:2] == ("safe_hold", "sleeve_in")


def test_a_case_that_the_command_ends_is_over(calm: Case) -> None:
    assert calm.command("case-aborted", reason="bleeding")["state"] == "aborted"
