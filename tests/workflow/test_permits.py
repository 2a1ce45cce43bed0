"""Permits: one approval, one motion, for thirty seconds, from here, by whoever holds control."""

from dataclasses import replace

import pytest

from workflow import facts as f
from workflow.plans import PlanKind
from workflow.refusals import RefusalCode
from workflow.snapshot import Reading
from workflow.states import GuideState, State
from workflow.triggers import Trigger


@pytest.fixture
def approved(walk):
    return walk.to(State.TARGET_CHOSEN)


def failed(refusal) -> set[str]:
    return {verdict.code for verdict in refusal.failed}


def test_a_permit_moves_the_arm_once(approved):
    start = approved.facts(Trigger.MOVE_STARTED)
    assert start.permit_id not in approved.do(Trigger.MOVE_STARTED, start).voided
    again = approved.refused(Trigger.MOVE_STARTED, start)
    assert again.code is RefusalCode.ARM_MOVING
    assert {"permit_unused", "permit_current"} <= failed(again)


def test_a_used_permit_is_refused_after_the_motion_too(approved):
    start = approved.facts(Trigger.MOVE_STARTED)
    approved.do(Trigger.MOVE_STARTED, start)
    approved.do(Trigger.RELEASED)
    again = approved.refused(Trigger.MOVE_STARTED, start)
    assert again.code is RefusalCode.MISSING
    assert "permit_unused" in failed(again)
    assert again.leads_onwards == (Trigger.PLAN_REQUESTED,)


def test_a_motion_takes_a_new_plan_after_the_last_one_was_released(approved):
    approved.do(Trigger.MOVE_STARTED)
    approved.do(Trigger.RELEASED)
    assert approved.refused(Trigger.MOVE_APPROVED).leads_onwards == (Trigger.PLAN_REQUESTED,)
    approved.do(Trigger.PLAN_REQUESTED)
    assert approved.refused(Trigger.MOVE_STARTED).leads_onwards == (Trigger.MOVE_APPROVED,)
    approved.do(Trigger.MOVE_APPROVED)
    approved.do(Trigger.MOVE_STARTED)


@pytest.mark.hazard("H23")
def test_the_clock_going_back_expires_a_permit(approved):
    approved.now_s -= 1.0
    assert failed(approved.refused(Trigger.MOVE_STARTED)) == {"permit_fresh"}


def test_a_permit_of_another_case_is_foreign(approved, new_walk):
    other = new_walk()
    for _ in range(50):
        other.new_id("permit")
    other.to(State.TARGET_CHOSEN)
    refusal = approved.refused(Trigger.MOVE_STARTED, other.facts(Trigger.MOVE_STARTED))
    assert failed(refusal) == {"permit_current"}


@pytest.mark.parametrize("trigger", [Trigger.STOP, Trigger.FAULT, Trigger.HOLD_REQUESTED, Trigger.RESTARTED])
def test_a_permit_does_not_survive_a_hold(approved, trigger):
    start = approved.facts(Trigger.MOVE_STARTED)
    voided = approved.do(trigger).voided
    assert start.permit_id in voided
    assert approved.refused(Trigger.MOVE_STARTED, start).code is RefusalCode.HELD
    approved.do(Trigger.ACKNOWLEDGED)
    assert approved.refused(Trigger.MOVE_STARTED, start).code is RefusalCode.MISSING


@pytest.mark.hazard("H22")
def test_a_new_plan_voids_the_permit_of_the_old_one(approved):
    start = approved.facts(Trigger.MOVE_STARTED)
    approved.do(Trigger.PLAN_REQUESTED)
    assert approved.refused(Trigger.MOVE_STARTED, start).code is RefusalCode.MISSING


def test_a_permit_is_worth_nothing_after_the_control_was_taken(approved):
    start = approved.facts(Trigger.MOVE_STARTED)
    approved.do(Trigger.LEASE_TAKEN, control_token=2)
    approved.spoil(control_token=Reading(2, 0.01))
    assert failed(approved.refused(Trigger.MOVE_STARTED, start)) == {"lease"}
    newer = replace(start, control_token=2)
    assert failed(approved.refused(Trigger.MOVE_STARTED, newer)) == {"permit_holder"}


@pytest.mark.hazard("H35")
def test_an_instrument_stated_after_the_approval_keeps_the_arm_still(approved):
    approved.do(Trigger.GUIDE_STATE_STATED, guide=GuideState.INSTRUMENT)
    refusal = approved.refused(Trigger.MOVE_STARTED)
    assert refusal.code is RefusalCode.INSTRUMENT_IN_GUIDE
    assert refusal.leads_onwards == (Trigger.GUIDE_STATE_STATED,)


@pytest.mark.hazard("H35")
@pytest.mark.parametrize(("axial", "moves"), [(True, True), (False, False)])
def test_along_a_wire_the_arm_only_retreats_on_the_axis(walk, axial, moves):
    walk.to(State.TARGET_CHOSEN).do(Trigger.GUIDE_STATE_STATED, guide=GuideState.WIRE)
    walk.do(Trigger.PLAN_REQUESTED, kind=PlanKind.RETREAT, axial=axial)
    if not moves:
        assert walk.refused(Trigger.MOVE_APPROVED).code is RefusalCode.INSTRUMENT_IN_GUIDE
        return
    walk.do(Trigger.MOVE_APPROVED)
    assert walk.do(Trigger.MOVE_STARTED).after.state is State.MOVING


def test_along_a_wire_no_other_kind_moves_the_arm_axial_or_not(walk):
    walk.to(State.TARGET_CHOSEN).do(Trigger.GUIDE_STATE_STATED, guide=GuideState.WIRE)
    walk.do(Trigger.PLAN_REQUESTED, axial=True)
    assert walk.refused(Trigger.MOVE_APPROVED).code is RefusalCode.INSTRUMENT_IN_GUIDE


def test_an_approach_needs_no_image_to_be_true_to(walk):
    unknown = Reading(None, float("inf"))
    walk.to(State.CARM_POSITIONED).spoil(unaccounted_mm=unknown, unaccounted_rad=unknown)
    walk.do(Trigger.PLAN_REQUESTED, kind=PlanKind.APPROACH)
    walk.do(Trigger.MOVE_APPROVED)
    assert walk.do(Trigger.MOVE_STARTED).after.state is State.MOVING


@pytest.mark.hazard("H22")
def test_a_permit_binds_what_its_plan_was_made_from(approved):
    case = approved.case
    assert case.permit.made_from == (case.plan.id, case.view.id, case.image.id, case.registration.id, case.target.id)
    assert case.permit.devices_hash == "devices"
    assert case.permit.joints_rad == case.plan.start_joints_rad


@pytest.mark.parametrize(
    ("state", "kind", "code"),
    [
        (State.CASE_OPEN, PlanKind.TARGETING, RefusalCode.MISSING),
        (State.REGISTERED, PlanKind.CORRECTIVE, RefusalCode.MISSING),
        (State.MOVED, PlanKind.TARGETING, RefusalCode.NOT_NOW),
        (State.REGISTERED, PlanKind.APPROACH, RefusalCode.NOT_NOW),
        (State.IMAGE_ACQUIRED, PlanKind.CALIBRATION, RefusalCode.NOT_NOW),
        (State.CASE_OPEN, PlanKind.NUDGE, RefusalCode.MISSING),
        (State.REGISTERED, PlanKind.NUDGE, RefusalCode.NOT_NOW),
    ],
)
def test_a_plan_kind_is_refused_where_it_has_no_place(walk, state, kind, code):
    assert walk.to(state).refused(Trigger.PLAN_REQUESTED, kind=kind).code is code


def test_facts_of_another_trigger_are_the_callers_mistake(walk):
    with pytest.raises(ValueError, match="comes with MoveStarted"):
        walk.ask(Trigger.MOVE_STARTED, f.Reasoned("x"))
