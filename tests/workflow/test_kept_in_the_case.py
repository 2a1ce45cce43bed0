"""What a step leaves in the case: ids, what each was made from, counts and flags."""

from dataclasses import replace

import pytest

from tests.workflow.proof import LIMITS
from workflow import changes, permits
from workflow.case import Insertion, Window, opened
from workflow.inquiry import Inquiry
from workflow.snapshot import Reading
from workflow.states import InsertionStatus, State
from workflow.triggers import Trigger


def test_a_new_case_has_counted_nothing():
    assert (opened("case").images, opened("case").corrections) == (0, 0)


def test_a_window_latches_the_joints_and_the_motion_that_its_image_will_show(walk):
    walk.to(State.MOVED).do(Trigger.EXPOSURE_REQUESTED)
    case, joints_rad = walk.case, walk.snapshot.joints_rad.value
    assert case.window == Window(case.window.id, walk.now_s, joints_rad, case.motion.id)


def test_an_exposure_may_be_asked_for_where_no_joints_are_known(walk):
    inquiry = asked(walk.to(State.CARM_POSITIONED), Trigger.EXPOSURE_REQUESTED, joints_rad=Reading(None, 0.01))
    assert changes.open_window(walk.case, inquiry).window.joints_rad == ()


def asked(walk, trigger: Trigger, **readings) -> Inquiry:
    facts = walk.facts(trigger)
    walk.spoil(**readings)
    return Inquiry(walk.case, trigger, facts, walk.snapshot, LIMITS, walk.now_s)


def test_every_link_says_what_it_was_made_from(walk):
    case = walk.to(State.VERIFIED).case
    assert case.image.made_from == (case.view.id,)
    assert case.registration.made_from == (case.image.id,)
    assert case.target.made_from == (case.image.id, case.registration.id)
    assert case.plan.made_from == (case.view.id, case.image.id, case.registration.id, case.target.id)
    assert case.motion.made_from == (case.plan.id, case.used_permit_id)
    assert case.verification.made_from == (case.verification.image_id, case.motion.id)


def test_a_correction_is_made_from_the_image_that_verified(walk):
    judged = walk.to(State.OFF_TARGET).case.verification.image_id
    case = walk.do(Trigger.CORRECTION_REQUESTED).after
    assert (case.image.id, case.image.made_from) == (judged, (case.view.id,))
    assert case.registration.made_from == (judged,)
    assert case.target.made_from == (judged, case.registration.id)
    assert case.corrections == 1


def test_an_image_to_be_evaluated_is_of_the_completed_motion(walk):
    walk.to(State.MOVED)
    assert walk.case.evaluated_image.made_from == (walk.case.motion.id,)
    assert walk.case.window is None


def test_a_withdrawn_target_takes_its_corrections_with_it(walk):
    walk.to(State.OFF_TARGET).do(Trigger.CORRECTION_REQUESTED)
    assert walk.do(Trigger.TARGET_WITHDRAWN).after.corrections == 0


def test_an_insertion_is_neither_verified_nor_flagged_before_the_sleeve_is_in(walk):
    started = walk.to(State.INSERTING).case.insertion
    assert started == Insertion(started.id, InsertionStatus.OPEN, verified=False, flagged=False)
    assert walk.do(Trigger.SLEEVE_IN).after.insertion == Insertion(
        started.id, InsertionStatus.DONE, True, flagged=False
    )


def test_a_sleeve_that_nobody_announced_is_not_flagged_for_it(walk):
    insertion = walk.to(State.VERIFIED).do(Trigger.SLEEVE_IN).after.insertion
    assert insertion == Insertion(insertion.id, InsertionStatus.DONE, verified=False, flagged=False)


def test_an_image_that_nobody_asked_for_may_be_reused_if_it_shows_what_is_there(walk):
    walk.to(State.IMAGE_ACQUIRED)
    walk.do(Trigger.IMAGE_ARRIVED, image_id="unasked")
    assert walk.case.newest_image_id == "unasked"
    walk.do(Trigger.RETAKE)
    assert walk.do(Trigger.NEWEST_IMAGE_REUSED).after.image.id == "unasked"


@pytest.mark.parametrize(
    ("change", "state", "trigger", "lost"),
    [
        (changes.start_motion, State.TARGET_CHOSEN, Trigger.MOVE_STARTED, {"plan": None}),
        (changes.start_motion, State.TARGET_CHOSEN, Trigger.MOVE_STARTED, {"permit": None}),
        (changes.complete_motion, State.MOVING, Trigger.ARRIVED, {"running": None}),
    ],
)
def test_a_motion_without_its_reason_is_the_rules_own_mistake(walk, change, state, trigger, lost):
    inquiry = asked(walk.to(state), trigger)
    with pytest.raises(ValueError):
        change(replace(walk.case, **lost), inquiry)


def test_another_motion_than_the_one_under_way_is_not_completed(walk):
    inquiry = asked(walk.to(State.MOVING), Trigger.ARRIVED)
    other = replace(walk.case, running=replace(walk.case.running, id="other"))
    with pytest.raises(ValueError, match="not under way"):
        changes.complete_motion(other, inquiry)


@pytest.mark.parametrize("lost", ["plan", "devices"])
def test_a_permit_binds_a_plan_and_known_device_files_or_is_none(walk, lost):
    walk.to(State.TARGET_CHOSEN)
    inquiry = asked(walk, Trigger.MOVE_APPROVED, **({"devices_hash": Reading(None, 0.01)} if lost == "devices" else {}))
    if lost == "plan":
        inquiry = replace(inquiry, case=replace(walk.case, plan=None))
    with pytest.raises(ValueError):
        permits.issue(inquiry)


def test_what_did_not_come_is_not_made_up(walk):
    asked_only = Inquiry(walk.case, Trigger.EXPOSURE_REQUESTED, None, walk.snapshot, LIMITS, walk.now_s)
    with pytest.raises(ValueError, match="exposure_requested"):
        changes.open_window(walk.case, asked_only)


@pytest.mark.parametrize("state", [State.INSERTING, State.OFF_TARGET, State.MOVED, State.VERIFIED])
def test_a_hold_ends_where_it_began(walk, state):
    walk.to(state).do(Trigger.HOLD_REQUESTED)
    assert walk.do(Trigger.ACKNOWLEDGED).after.state is state
