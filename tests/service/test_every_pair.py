"""Every state x every trigger over HTTP: taken as the table says, or refused, typed, remembered and without effect.

The room has no arm, so that what needs one is refused by an interlock. The cases are put into their states by
recording them there; what is expected comes from the second table, which is written independently of the rules.
"""

import pytest

from coaxial_client import Refused
from service.errors import ANSWERS, ErrorCode
from tests.service.any_state import NamedApart, Room
from tests.workflow.test_table import CELLS, chain_after, insertion, letters, prepare, refusal_of, settled
from workflow.case import CaseState
from workflow.refusals import RefusalCode
from workflow.states import OVER, State
from workflow.triggers import Kind, Trigger

# What a listed request is refused for in this room: without an arm, an image, or the end of every target.
_LACKING = {
    Trigger.CARM_POSITION_CONFIRMED: "interlock",
    Trigger.EXPOSURE_REQUESTED: "interlock",
    Trigger.NEWEST_IMAGE_REUSED: "interlock",
    Trigger.TARGET_CONFIRMED: "interlock",
    Trigger.PLAN_REQUESTED: "arm_unknown",
    Trigger.MOVE_APPROVED: "interlock",
    Trigger.MOVE_STARTED: "interlock",
    Trigger.INSERTION_STARTED: "interlock",
    Trigger.ACKNOWLEDGED: "interlock",
    Trigger.CASE_CLOSED: "targets_open",
    Trigger.LABEL: "image_unknown",
}


def expected_refusal(case: CaseState, trigger: Trigger) -> str | None:
    """The code of the refusal in this room; None where the trigger is taken."""
    if trigger.kind is Kind.OBSERVATION:
        return ErrorCode.UNKNOWN_PATH  # nobody tells the service what only it observes
    if trigger is Trigger.CORRECTION_REQUESTED and case.verification is not None and case.target is not None:
        return ErrorCode.ARTEFACT_UNKNOWN  # the figures of the evaluation are read before the rules are asked
    if (case.state.value, trigger.value) in CELLS:
        return _LACKING.get(trigger)
    return refusal_of(case, trigger) if trigger.kind is Kind.REQUEST else None


def check_refused(room: Room, before: CaseState, trigger: Trigger, refused: Refused, expected: str) -> None:
    assert (refused.code, refused.status) == (expected, ANSWERS[expected].status), (before.state, trigger)
    assert room.stands() == before
    if trigger.kind is Kind.REQUEST and expected in set(RefusalCode):
        assert room.remembers() == (trigger, False, expected, before.state)
        assert refused.leads_onwards or before.state in OVER


def check_taken(room: Room, before: CaseState, trigger: Trigger) -> None:
    listed = CELLS.get((before.state.value, trigger.value))
    after = room.stands().state
    if listed is None or listed.to == "same":
        assert after is before.state, trigger
        return
    passed = before.verification is not None and before.verification.passed
    slots = dict(effect.split("=") for effect in listed.effects if "=" in effect)
    chain = chain_after(letters(before), listed.effects, passed)
    settles_to = settled(chain, passed, slots.get("S", insertion(before)))
    assert after.value == (settles_to if listed.to == "settle" else listed.to), trigger


@pytest.mark.parametrize("state", State)
def test_every_trigger_is_taken_as_the_table_says_or_refused_without_effect(room, state):
    for trigger in Trigger:
        before = room.put(prepare(NamedApart(), state, trigger))
        expected = expected_refusal(before, trigger)
        if expected is None:
            room.send(trigger, before)
            check_taken(room, before, trigger)
        else:
            with pytest.raises(Refused) as caught:
                room.send(trigger, before)
            check_refused(room, before, trigger, caught.value, expected)
