"""A result that the rules refuse says why, and what leads onwards, as a refused image does."""

from dataclasses import replace
from typing import Any

import pytest

from service.auth.permissions import Role
from service.cases import store
from service.cases.records import NewCase, NewEvent
from service.conductor.unusable import why_unusable
from service.database.engines import Database
from tests.workflow.conftest import Walk
from workflow.case_json import to_json
from workflow.decisions import Decision
from workflow.states import State
from workflow.triggers import Trigger

_OPENED = NewEvent("case_opened", None, "case_open", {"state": "case_open"}, {})

# The way out that is told: a registration where the guide is now, and the motion that it leads to.
_ANEW = (
    *(Trigger.TARGET_WITHDRAWN, Trigger.RETAKE),
    *(Trigger.EXPOSURE_REQUESTED, Trigger.IMAGE_ARRIVED, Trigger.REGISTRATION_COMPLETED, Trigger.TARGET_CONFIRMED),
    *(Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED, Trigger.ARRIVED),
)


def _found(position_mm: float, angle_deg: float) -> dict[str, Any]:
    return {
        "difference": {"position_error_mm": position_mm, "angle_error_deg": angle_deg},
        "difference_limit": {"position_error_mm": 0.06, "angle_error_deg": 0.03},
    }


@pytest.fixture
def case_of(database, users) -> Database:
    """A database in which the walk's case is open."""
    user_id = users.add("anna", Role.SURGEON, "correct horse", "2468").id
    new = NewCase("case", "room-1", "P1", "1.2.3", user_id, "0" * 64, {}, {})
    with database.write() as connection:
        store.open_case(connection, new, _OPENED)
    return database


def _told(database: Database, decision: Decision, found: dict[str, Any]) -> dict[str, Any]:
    """What is told of a decision, which is in the record from then on."""
    with database.write() as connection:
        told = why_unusable(connection, decision, found)
        event = NewEvent(decision.taken_as, None, decision.after.state, to_json(decision.after), told)
        store.append(connection, "case", event, expected_version=None)
    return told


def _disagree(walk: Walk) -> Decision:
    if walk.case.evaluated_image is None:
        walk.do(Trigger.EXPOSURE_REQUESTED)
        walk.do(Trigger.IMAGE_ARRIVED)
    return walk.do(Trigger.VERIFICATION_PASSED, agree=False)


@pytest.mark.hazard("H33")
def test_only_a_repeated_disagreement_about_the_same_motion_is_told_as_one(case_of):
    walk = Walk().to(State.MOVED)
    codes = [_told(case_of, _disagree(walk), _found(0.09, 0.01))["reason"]["code"] for _ in range(3)]
    assert codes == ["evaluations_disagree", "evaluations_disagree_again", "evaluations_disagree_again"]
    for trigger in _ANEW:
        walk.do(trigger)
    assert _told(case_of, _disagree(walk), _found(0.09, 0.01))["reason"]["code"] == "evaluations_disagree"


@pytest.mark.parametrize(
    ("found", "told"), [(_found(0.09, 0.04), (0.09, 0.06, "mm")), (_found(0.05, 0.04), (0.04, 0.03, "deg"))]
)
def test_a_disagreement_tells_the_difference_that_is_beyond_its_limit(case_of, found, told):
    reason = _told(case_of, _disagree(Walk().to(State.MOVED)), found)["reason"]
    assert (reason["measured"], reason["limit"], reason["unit"]) == told


def test_a_disagreement_found_in_a_hold_leads_out_of_the_hold_first(case_of):
    walk = Walk().to(State.MOVED)
    walk.do(Trigger.STOP)
    assert _told(case_of, _disagree(walk), _found(0.09, 0.01))["leads_onwards"] == ["acknowledged"]


def test_an_unsound_registration_names_what_refused_it_and_another_exposure(case_of):
    walk = Walk().to(State.IMAGE_ACQUIRED)
    quality = walk.facts(Trigger.REGISTRATION_COMPLETED).quality
    decision = walk.do(Trigger.REGISTRATION_COMPLETED, quality=replace(quality, residual_rms_px=9.0))
    told = _told(case_of, decision, {})
    assert (told["reason"]["code"], told["reason"]["measured"]) == ("residual", 9.0)
    assert told["leads_onwards"] == ["exposure_requested"]


def test_nothing_is_told_beside_a_result_that_counts(case_of):
    walk = Walk().to(State.MOVED)
    assert _told(case_of, walk.do(Trigger.VERIFICATION_PASSED), _found(0.01, 0.01)) == {}
