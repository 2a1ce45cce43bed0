"""Which targets are drawn over an image: those that are the same place in it."""

import pytest

from service.auth.permissions import Role
from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact, NewCase, NewEvent
from service.conductor.overlays import targets_of_view
from workflow.triggers import Trigger


@pytest.fixture
def happen(database, users):
    surgeon = users.add("anna", Role.SURGEON, "correct horse", "2468")
    new = NewCase("case-1", "room-1", "P1", "1.2.3", surgeon.id, "0" * 64, {"guide": "g"}, {"L4 left": {"depth": 1}})
    with database.write() as connection:
        store.open_case(connection, new, NewEvent("case_opened", None, "case_open", {}, {}))

    def happen_now(trigger: Trigger, *targets: str) -> int:
        made = [NewArtefact(ArtefactKind.TARGET, one, (), {}, {}) for one in targets]
        event = NewEvent(trigger, None, "registered", {}, {})
        with database.write() as connection:
            return store.append(connection, "case-1", event, expected_version=None, artefacts=made).sequence

    return happen_now


def _drawn(database, sequence: int) -> list[str]:
    with database.read() as connection:
        return [one.id for one in targets_of_view(connection, "case-1", sequence)]


@pytest.mark.parametrize("moved", [Trigger.CARM_POSITION_CONFIRMED, Trigger.CARM_MOVED, Trigger.PATIENT_MOVED])
def test_a_target_is_drawn_until_c_arm_or_patient_move(database, happen, moved):
    happen(Trigger.CARM_POSITION_CONFIRMED)
    first = happen(Trigger.REGISTRATION_COMPLETED)
    happen(Trigger.TARGET_CONFIRMED, "picked")
    again = happen(Trigger.REGISTRATION_COMPLETED)
    happen(Trigger.CORRECTION_REQUESTED, "corrected")
    happen(moved)
    later = happen(Trigger.REGISTRATION_COMPLETED)
    assert _drawn(database, first) == _drawn(database, again) == ["picked", "corrected"]
    assert _drawn(database, later) == []
    happen(Trigger.TARGET_CONFIRMED, "another")
    assert _drawn(database, later) == ["another"]
    assert _drawn(database, again) == ["picked", "corrected"]
