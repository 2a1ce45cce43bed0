"""Refusals: the first reason in the stated order, and what leads onwards really does."""

from dataclasses import replace

import pytest

from workflow.machine import allowed, plan_kinds
from workflow.onwards import route
from workflow.plans import PlanKind
from workflow.refusals import RefusalCode
from workflow.snapshot import Reading, SafetyMode
from workflow.states import GuideState, State
from workflow.totality import listed
from workflow.triggers import REQUESTS, Trigger

# Nobody needs a way to these: they are for calm states only, or always possible.
ENDS = (State.CLOSED, State.ABORTED)


@pytest.mark.parametrize(
    ("state", "trigger", "code", "onwards"),
    [
        (State.CLOSED, Trigger.MOVE_STARTED, RefusalCode.CASE_OVER, (Trigger.READ, Trigger.EXPORT, Trigger.NOTE)),
        (State.SAFE_HOLD, Trigger.RETAKE, RefusalCode.HELD, (Trigger.ACKNOWLEDGED,)),
        (State.MOVING, Trigger.CASE_CLOSED, RefusalCode.ARM_MOVING, (Trigger.RELEASED, Trigger.STOP)),
        (
            State.INSERTING,
            Trigger.MOVE_STARTED,
            RefusalCode.INSTRUMENT_IN_GUIDE,
            (Trigger.INSERTION_CANCELLED, Trigger.SLEEVE_IN),
        ),
        (State.SLEEVE_INSERTED, Trigger.CASE_CLOSED, RefusalCode.INSTRUMENT_IN_GUIDE, (Trigger.SLEEVE_REMOVED,)),
        (State.SLEEVE_INSERTED, Trigger.TARGET_DONE, RefusalCode.INSTRUMENT_IN_GUIDE, (Trigger.SLEEVE_REMOVED,)),
        (
            State.INSERTING,
            Trigger.RETAKE,
            RefusalCode.INSERTION_RUNNING,
            (Trigger.SLEEVE_IN, Trigger.INSERTION_CANCELLED),
        ),
        (State.SLEEVE_INSERTED, Trigger.RETAKE, RefusalCode.INSERTION_RUNNING, (Trigger.SLEEVE_REMOVED,)),
        (State.CASE_OPEN, Trigger.EXPOSURE_REQUESTED, RefusalCode.MISSING, (Trigger.CARM_POSITION_CONFIRMED,)),
        (State.CARM_POSITIONED, Trigger.TARGET_CONFIRMED, RefusalCode.MISSING, (Trigger.EXPOSURE_REQUESTED,)),
        (State.IMAGE_ACQUIRED, Trigger.TARGET_CONFIRMED, RefusalCode.MISSING, (Trigger.REGISTRATION_COMPLETED,)),
        (State.REGISTERED, Trigger.MOVE_APPROVED, RefusalCode.MISSING, (Trigger.PLAN_REQUESTED,)),
        (State.REGISTERED, Trigger.INSERTION_STARTED, RefusalCode.MISSING, (Trigger.TARGET_CONFIRMED,)),
        (State.TARGET_CHOSEN, Trigger.INSERTION_STARTED, RefusalCode.MISSING, (Trigger.MOVE_STARTED,)),
        (State.MOVED, Trigger.INSERTION_STARTED, RefusalCode.MISSING, (Trigger.EXPOSURE_REQUESTED,)),
        (State.OFF_TARGET, Trigger.EXPOSURE_REQUESTED, RefusalCode.NOT_NOW, (Trigger.VERIFICATION_REJECTED,)),
        (
            State.REGISTERED,
            Trigger.CARM_POSITION_CONFIRMED,
            RefusalCode.NOT_NOW,
            (Trigger.RETAKE, Trigger.CARM_MOVED),
        ),
        (State.VERIFIED, Trigger.TARGET_DONE, RefusalCode.NOT_NOW, (Trigger.INSERTION_STARTED,)),
    ],
)
def test_a_refusal_names_what_leads_onwards(walk, state, trigger, code, onwards):
    refusal = walk.to(state).refused(trigger)
    assert (refusal.code, refusal.leads_onwards) == (code, onwards)


def test_the_first_step_of_a_long_way_is_shown(walk):
    far = walk.to(State.CASE_OPEN).case
    assert Trigger.CARM_POSITION_CONFIRMED in route(far, frozenset({State.VERIFIED}))


@pytest.mark.parametrize(
    ("lost", "first"),
    [
        ({}, Trigger.MOVE_STARTED),
        ({"permit": None}, Trigger.MOVE_APPROVED),
        ({"permit": None, "plan": None}, Trigger.PLAN_REQUESTED),
    ],
)
def test_towards_a_motion_the_next_that_a_person_does_is_shown(walk, lost, first):
    case = replace(walk.to(State.TARGET_CHOSEN).case, **lost)
    assert route(case, frozenset({State.MOVING})) == (first,)


def test_an_insertion_whose_guide_is_empty_again_is_over_once_the_target_is_done(walk):
    walk.to(State.SLEEVE_INSERTED).do(Trigger.SLEEVE_REMOVED)
    refusal = walk.refused(Trigger.RETAKE)
    assert (refusal.code, refusal.leads_onwards) == (RefusalCode.INSERTION_RUNNING, (Trigger.TARGET_DONE,))


def test_every_refusal_of_a_live_case_names_something_that_can_be_done_there(new_walk):
    """Requests named are listed in that state, observations and facts are open to it."""
    for state in (state for state in State if state not in ENDS):
        for trigger in REQUESTS:
            walk = new_walk().to(state)
            for onwards in getattr(walk.ask(trigger), "leads_onwards", ()):
                assert listed(state, onwards), f"{trigger} in {state}: {onwards}"


def test_an_unaccounted_arm_leads_to_what_a_person_can_do(new_walk):
    """A disturbance is observed, not asked for; where nothing is known of it, none is ever observed."""
    aiming, reusing = new_walk().to(State.TARGET_CHOSEN), new_walk().to(State.IMAGE_ACQUIRED)
    reusing.do(Trigger.RETAKE)
    for walk in (aiming, reusing):
        walk.spoil(unaccounted_mm=Reading(None, float("inf")))
    assert aiming.refused(Trigger.MOVE_STARTED).leads_onwards == (Trigger.RETAKE,)
    assert reusing.refused(Trigger.NEWEST_IMAGE_REUSED).leads_onwards == (Trigger.EXPOSURE_REQUESTED,)


def test_following_what_leads_onwards_reaches_the_insertion(walk):
    """From an empty case to the sleeve by doing nothing but what the refusals say."""
    walk.do(Trigger.GUIDE_STATE_STATED)
    for _ in range(20):
        answer = walk.ask(Trigger.INSERTION_STARTED)
        if walk.case.state is State.INSERTING:
            return
        step = answer.leads_onwards[0]
        walk.do(step)
        follow_up(walk, step)
    pytest.fail(f"stuck in {walk.case.state}")


def follow_up(walk, step: Trigger) -> None:
    """What the room answers."""
    if step is Trigger.EXPOSURE_REQUESTED:
        walk.do(Trigger.IMAGE_ARRIVED)
        if walk.case.state is State.MOVED:
            walk.do(Trigger.VERIFICATION_PASSED)
    if step is Trigger.MOVE_STARTED:
        walk.do(Trigger.ARRIVED)


def test_a_verified_case_with_the_carm_turned_away_is_shown_the_way_back(walk):
    walk.to(State.VERIFIED).do(Trigger.CARM_MOVED)
    refusal = walk.refused(Trigger.CORRECTION_REQUESTED)
    assert refusal.code is RefusalCode.MISSING
    assert refusal.leads_onwards == (Trigger.TARGET_WITHDRAWN, Trigger.VERIFICATION_REJECTED)
    walk.do(Trigger.VERIFICATION_REJECTED)
    walk.do(Trigger.CARM_POSITION_CONFIRMED)


@pytest.mark.parametrize(
    ("state", "trigger"),
    [
        (State.REGISTERED, Trigger.RETAKE),
        (State.MOVED, Trigger.TARGET_WITHDRAWN),
        (State.VERIFIED, Trigger.VERIFICATION_REJECTED),
        (State.REGISTERED, Trigger.LEASE_TAKEN),
    ],
)
def test_some_requests_need_a_reason(walk, state, trigger):
    assert walk.to(state).refused(trigger, reason="").code is RefusalCode.REASON_REQUIRED


def test_a_target_is_abandoned_with_a_reason_only(walk):
    walk.to(State.SLEEVE_INSERTED).do(Trigger.SLEEVE_REMOVED)
    assert walk.refused(Trigger.TARGET_DONE, placed=False).code is RefusalCode.REASON_REQUIRED
    walk.do(Trigger.TARGET_DONE, placed=False, reason="bone too hard")


def test_the_third_correction_of_a_target_needs_a_reason(walk):
    walk.to(State.OFF_TARGET)
    for _ in range(2):
        walk.do(Trigger.CORRECTION_REQUESTED)
        for trigger in (Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED, Trigger.ARRIVED):
            walk.do(trigger)
        for trigger in (Trigger.EXPOSURE_REQUESTED, Trigger.IMAGE_ARRIVED, Trigger.VERIFICATION_FAILED):
            walk.do(trigger)
    assert walk.refused(Trigger.CORRECTION_REQUESTED).code is RefusalCode.REASON_REQUIRED
    walk.do(Trigger.CORRECTION_REQUESTED, reason="the needle bent")
    assert walk.case.corrections == 3
    walk.do(Trigger.TARGET_CONFIRMED)
    assert walk.case.corrections == 0


def test_only_a_surgeon_acknowledges_and_papers_need_their_role(walk):
    walk.to(State.SAFE_HOLD)
    assert walk.refused(Trigger.ACKNOWLEDGED, surgeon=False).code is RefusalCode.ROLE
    assert walk.refused(Trigger.EXPORT, permitted=False).code is RefusalCode.ROLE


def test_a_case_with_open_targets_is_not_closed(walk):
    refusal = walk.to(State.REGISTERED).refused(Trigger.CASE_CLOSED, open_targets=1)
    assert refusal.code is RefusalCode.TARGETS_OPEN


@pytest.mark.hazard("H18")
@pytest.mark.parametrize("mode", [SafetyMode.PROTECTIVE_STOP, SafetyMode.EMERGENCY_STOP, SafetyMode.OFF])
def test_a_hold_lasts_while_its_cause_does(walk, mode):
    """H18: nothing but the cause going away and a surgeon's acknowledgement ends it."""
    walk.to(State.MOVING).do(Trigger.FAULT)
    walk.spoil(safety_mode=Reading(mode, 0.01))
    assert walk.refused(Trigger.ACKNOWLEDGED).code is RefusalCode.INTERLOCK
    walk.spoil(safety_mode=Reading(SafetyMode.NORMAL, 0.01))
    assert walk.do(Trigger.ACKNOWLEDGED).after.state is State.TARGET_CHOSEN
    assert walk.refused(Trigger.MOVE_APPROVED).leads_onwards == (Trigger.PLAN_REQUESTED,)


def test_every_refusal_holds_the_verdicts_that_passed_too(walk):
    walk.to(State.TARGET_CHOSEN).spoil(at_rest=Reading(False, 0.01))
    refusal = walk.refused(Trigger.MOVE_STARTED)
    assert [verdict.code for verdict in refusal.failed] == ["at_rest"]
    assert len(refusal.verdicts) > 20


def test_what_is_allowed_agrees_with_what_is_taken(new_walk):
    """The status never offers what is refused, nor hides what is taken, when all that comes with it is well."""
    for state in State:
        walk = new_walk().to(state)
        start = walk.case
        status = allowed(start, walk.snapshot, walk.limits, walk.now_s)
        assert set(status) == set(REQUESTS)
        for trigger in REQUESTS:
            walk.case = start
            kind = PlanKind.TARGETING if PlanKind.TARGETING in plan_kinds(start) else PlanKind.RETREAT
            taken = hasattr(walk.ask(trigger, kind=kind), "after")
            offered = status[trigger]
            assert offered.allowed or not taken, f"{trigger} in {state}"
            needs_more = trigger is Trigger.NEWEST_IMAGE_REUSED  # only the request says which image
            assert taken or not offered.allowed or needs_more, f"{trigger} in {state}"
            assert offered.allowed or offered.leads_onwards


def test_the_status_gives_every_reason_at_once(walk):
    walk.to(State.TARGET_CHOSEN).do(Trigger.GUIDE_STATE_STATED, guide=GuideState.UNKNOWN)
    walk.spoil(at_rest=Reading(False, 0.01), safety_mode=Reading(SafetyMode.PROTECTIVE_STOP, 0.01))
    offered = allowed(walk.case, walk.snapshot, walk.limits, walk.now_s)[Trigger.MOVE_STARTED]
    codes = {verdict.code for verdict in offered.reasons}
    assert codes == {"at_rest", "safety_normal", "guide_empty", "permit_guide"}


def test_the_held_button_is_no_reason_before_it_is_pressed(walk):
    walk.to(State.TARGET_CHOSEN).spoil(hold_pressed=Reading(None, 9.0), challenge_echoed=Reading(None, 9.0))
    assert allowed(walk.case, walk.snapshot, walk.limits, walk.now_s)[Trigger.MOVE_STARTED].allowed
    assert walk.refused(Trigger.MOVE_STARTED).code is RefusalCode.INTERLOCK


def test_plan_kinds_follow_the_state(new_walk):
    expected = {
        State.CASE_OPEN: {PlanKind.APPROACH, PlanKind.CALIBRATION, PlanKind.RETREAT},
        State.CARM_POSITIONED: {PlanKind.APPROACH, PlanKind.CALIBRATION, PlanKind.NUDGE, PlanKind.RETREAT},
        State.TARGET_CHOSEN: {PlanKind.TARGETING, PlanKind.CORRECTIVE, PlanKind.RETREAT},
        State.MOVED: {PlanKind.RETREAT},
        State.MOVING: set(),
        State.INSERTING: set(),
        State.SAFE_HOLD: set(),
    }
    for state, kinds in expected.items():
        assert set(plan_kinds(new_walk().to(state).case)) == kinds
