"""Observations and facts: never refused, late when their subject is gone, doubted when the checks say otherwise."""

import pytest

from workflow import facts as f
from workflow.decisions import Effect, ImageUse, Outcome
from workflow.plans import PlanKind
from workflow.states import GuideState, InsertionStatus, State
from workflow.triggers import Trigger


def test_an_image_in_the_window_is_for_registration(walk):
    decision = walk.to(State.CARM_POSITIONED).do(Trigger.IMAGE_ARRIVED)
    assert decision.image_use is ImageUse.REGISTRATION
    assert decision.effects == (Effect.REGISTRATION_STARTS,)
    assert walk.case.window is None


def test_only_one_image_enters_a_window(walk):
    walk.to(State.MOVED)
    walk.do(Trigger.EXPOSURE_REQUESTED)
    assert walk.do(Trigger.IMAGE_ARRIVED).image_use is ImageUse.VERIFICATION
    assert walk.do(Trigger.IMAGE_ARRIVED).image_use is ImageUse.UNASSIGNED


@pytest.mark.parametrize(
    ("doubt", "use"),
    [
        ({"patient_matches": False}, ImageUse.QUARANTINED),
        ({"study_matches": None}, ImageUse.QUARANTINED),
        ({"sop_uid_unseen": False}, ImageUse.QUARANTINED),
        ({"pixels_unseen": False}, ImageUse.QUARANTINED),
        ({"newer_by_carm_clock": False}, ImageUse.QUARANTINED),
        ({"moved_mm": 0.1}, ImageUse.UNASSIGNED),
    ],
)
def test_a_doubtful_image_is_counted_and_leaves_the_window_open(walk, doubt, use):
    walk.to(State.CARM_POSITIONED)
    decision = walk.do(Trigger.IMAGE_ARRIVED, **doubt)
    assert decision.image_use is use
    assert walk.case.images == 1
    assert walk.case.newest_image_id is None
    assert walk.do(Trigger.IMAGE_ARRIVED).image_use is ImageUse.REGISTRATION


def test_images_are_counted_in_every_state(new_walk):
    for state in State:
        walk = new_walk().to(state)
        before = walk.case.images
        walk.do(Trigger.IMAGE_ARRIVED)
        assert walk.case.images == before + 1


def test_a_window_does_not_outlive_its_view(walk):
    walk.to(State.CARM_POSITIONED).do(Trigger.CARM_MOVED)
    walk.do(Trigger.CARM_POSITION_CONFIRMED)
    assert walk.do(Trigger.IMAGE_ARRIVED).image_use is ImageUse.UNASSIGNED


def test_a_new_position_takes_neither_window_nor_newest_image_over(walk):
    walk.to(State.IMAGE_ACQUIRED).do(Trigger.RETAKE)
    walk.do(Trigger.EXPOSURE_REQUESTED)
    walk.do(Trigger.CARM_POSITION_CONFIRMED)
    assert walk.case.newest_image_id is None
    assert walk.do(Trigger.IMAGE_ARRIVED).image_use is ImageUse.UNASSIGNED


@pytest.mark.hazard("H02")
@pytest.mark.parametrize("moved", [Trigger.PATIENT_MOVED, Trigger.ARM_DISTURBED, Trigger.HAND_GUIDED])
def test_an_image_that_was_on_its_way_when_something_moved_enters_no_chain(walk, moved):
    """It may have been exposed before: the window closes, and the C-arm need not be positioned anew."""
    walk.to(State.CARM_POSITIONED).do(moved)
    assert walk.case.state is State.CARM_POSITIONED
    assert walk.do(Trigger.IMAGE_ARRIVED).image_use is ImageUse.UNASSIGNED
    walk.do(Trigger.EXPOSURE_REQUESTED)
    assert walk.do(Trigger.IMAGE_ARRIVED).image_use is ImageUse.REGISTRATION


def test_a_commanded_motion_outdates_the_newest_image_too(walk):
    """Row 6: nothing moved since, the arm no less than the patient."""
    walk.to(State.IMAGE_ACQUIRED).do(Trigger.RETAKE)
    again = walk.facts(Trigger.NEWEST_IMAGE_REUSED)
    walk.do(Trigger.PLAN_REQUESTED, kind=PlanKind.NUDGE)
    for trigger in (Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED, Trigger.ARRIVED):
        walk.do(trigger)
    assert walk.case.state is State.CARM_POSITIONED
    assert [verdict.code for verdict in walk.refused(Trigger.NEWEST_IMAGE_REUSED, again).failed] == ["newest_image"]


def test_a_registration_that_fails_a_check_is_taken_as_refused(walk):
    walk.to(State.IMAGE_ACQUIRED)
    good = walk.facts(Trigger.REGISTRATION_COMPLETED)
    mirrored = f.RegistrationCompleted("r", good.image_id, quality=with_doubt(good.quality))
    decision = walk.do(Trigger.REGISTRATION_COMPLETED, mirrored)
    assert decision.taken_as is Trigger.REGISTRATION_REFUSED
    assert (walk.case.state, walk.case.image) == (State.CARM_POSITIONED, None)


def with_doubt(quality: f.RegistrationQuality) -> f.RegistrationQuality:
    values = {name: getattr(quality, name) for name in quality.__slots__}
    return f.RegistrationQuality(**{**values, "handedness_proved": None})


def test_a_registration_of_a_retaken_image_is_late(walk):
    walk.to(State.IMAGE_ACQUIRED)
    old = walk.facts(Trigger.REGISTRATION_COMPLETED)
    walk.do(Trigger.RETAKE)
    walk.do(Trigger.EXPOSURE_REQUESTED)
    walk.do(Trigger.IMAGE_ARRIVED)
    decision = walk.do(Trigger.REGISTRATION_COMPLETED, old)
    assert decision.outcome is Outcome.LATE
    assert walk.case.registration is None


def test_results_that_finish_in_a_hold_attach_if_their_parents_are_valid(walk):
    walk.to(State.IMAGE_ACQUIRED).do(Trigger.HOLD_REQUESTED)
    walk.do(Trigger.REGISTRATION_COMPLETED)
    assert walk.case.state is State.SAFE_HOLD
    assert walk.do(Trigger.ACKNOWLEDGED).after.state is State.REGISTERED


def test_a_second_result_of_the_same_image_is_late(walk):
    walk.to(State.REGISTERED).do(Trigger.HOLD_REQUESTED)
    before = walk.case
    assert walk.do(Trigger.REGISTRATION_COMPLETED).outcome is Outcome.LATE
    assert walk.case == before


def test_a_retreat_that_arrives_leaves_nothing_to_verify(walk):
    walk.to(State.REGISTERED).do(Trigger.PLAN_REQUESTED, kind=PlanKind.RETREAT)
    for trigger in (Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED, Trigger.ARRIVED):
        walk.do(trigger)
    assert (walk.case.state, walk.case.motion) == (State.REGISTERED, None)


def test_a_verification_that_finishes_in_a_hold_attaches(walk):
    walk.to(State.MOVED).do(Trigger.STOP)
    walk.do(Trigger.VERIFICATION_PASSED)
    assert walk.do(Trigger.ACKNOWLEDGED).after.state is State.VERIFIED


@pytest.mark.hazard("H28")
def test_a_verification_of_what_moved_meanwhile_is_late(walk):
    walk.to(State.MOVED)
    result = walk.facts(Trigger.VERIFICATION_PASSED)
    walk.do(Trigger.HOLD_REQUESTED)
    walk.do(Trigger.PATIENT_MOVED)
    assert walk.do(Trigger.VERIFICATION_PASSED, result).outcome is Outcome.LATE
    assert walk.case.verification is None


@pytest.mark.hazard("H28")
def test_a_result_from_before_the_newest_motion_is_late(walk):
    """H28: the image shows where the guide was, not where it is."""
    walk.to(State.MOVED)
    result = walk.facts(Trigger.VERIFICATION_PASSED)
    for trigger in (Trigger.TARGET_CONFIRMED, Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED):
        walk.do(trigger)
    walk.do(Trigger.ARRIVED)
    assert walk.do(Trigger.VERIFICATION_PASSED, result).outcome is Outcome.LATE
    assert walk.case.state is State.MOVED


def test_a_passed_verification_beyond_the_limits_is_taken_as_failed(walk):
    decision = walk.to(State.MOVED).do(Trigger.VERIFICATION_PASSED, position_error_mm=1.45)
    assert decision.taken_as is Trigger.VERIFICATION_FAILED
    assert walk.case.state is State.OFF_TARGET


@pytest.mark.hazard("H33")
def test_evaluations_that_disagree_verify_nothing_and_a_new_exposure_is_allowed(walk):
    decision = walk.to(State.MOVED).do(Trigger.VERIFICATION_PASSED, agree=False)
    assert decision.taken_as is Trigger.VERIFICATION_REFUSED
    assert (walk.case.state, walk.case.verification) == (State.MOVED, None)
    walk.do(Trigger.EXPOSURE_REQUESTED)
    walk.do(Trigger.IMAGE_ARRIVED)
    assert walk.do(Trigger.VERIFICATION_PASSED).after.state is State.VERIFIED


@pytest.mark.hazard("H03")
def test_rings_that_move_otherwise_than_the_arm_void_the_view(walk):
    """H03: whether the error would pass or not, and though the anatomy shifts with the C-arm."""
    moved = {"motion_chi_square": 40.0, "anatomy_across_mm": 9.0}
    decision = walk.to(State.MOVED).do(Trigger.VERIFICATION_PASSED, **moved)
    assert decision.taken_as is Trigger.CARM_MOVED
    assert (walk.case.state, walk.case.view, walk.case.registration) == (State.CASE_OPEN, None, None)
    assert (walk.case.verification, walk.case.newest_image_id) == (None, None)


@pytest.mark.hazard("H34")
def test_anatomy_that_shifted_voids_the_image_and_keeps_the_view(walk):
    """H34: the C-arm stands, another image is taken from where it is."""
    decision = walk.to(State.MOVED).do(Trigger.VERIFICATION_FAILED, anatomy_across_mm=1.0)
    assert decision.taken_as is Trigger.PATIENT_MOVED
    assert walk.case.state is State.CARM_POSITIONED
    assert (walk.case.image, walk.case.target, walk.case.verification) == (None, None, None)


@pytest.mark.parametrize("unknown", ["motion_chi_square", "anatomy_across_mm", "anatomy_along_mm"])
def test_what_could_not_be_compared_verifies_nothing_and_voids_nothing(walk, unknown):
    decision = walk.to(State.MOVED).do(Trigger.VERIFICATION_PASSED, **{unknown: None})
    assert decision.taken_as is Trigger.VERIFICATION_REFUSED
    assert (walk.case.state, walk.case.verification) == (State.MOVED, None)
    assert walk.case.registration is not None


def test_a_comparison_that_finishes_in_safe_hold_voids_there_with_an_alarm(walk):
    walk.to(State.MOVED).do(Trigger.STOP)
    decision = walk.do(Trigger.VERIFICATION_PASSED, motion_chi_square=40.0)
    assert (decision.taken_as, decision.effects) == (Trigger.CARM_MOVED, (Effect.ALARM,))
    assert (walk.case.state, walk.case.view) == (State.SAFE_HOLD, None)


@pytest.mark.parametrize(
    "far", [{"distance_mm": 0.11}, {"distance_mm": None}, {"angle_rad": 0.001}, {"angle_rad": float("nan")}]
)
def test_an_arrival_elsewhere_is_no_motion_to_verify(walk, far):
    walk.to(State.MOVING).do(Trigger.ARRIVED, **far)
    assert (walk.case.state, walk.case.motion) == (State.TARGET_CHOSEN, None)


@pytest.mark.parametrize("ended", [Trigger.ARRIVED, Trigger.MISSED, Trigger.RELEASED])
@pytest.mark.parametrize("at_rest", [False, None])
def test_a_motion_that_ended_without_rest_is_a_disturbed_arm(walk, ended, at_rest):
    decision = walk.to(State.MOVING).do(ended, at_rest=at_rest)
    assert decision.taken_as is Trigger.ARM_DISTURBED
    assert decision.effects == (Effect.STOP_SENT,)
    assert (walk.case.state, walk.case.image) == (State.SAFE_HOLD, None)


@pytest.mark.parametrize("ended", [Trigger.ARRIVED, Trigger.MISSED, Trigger.RELEASED])
def test_the_end_of_another_motion_is_late(walk, ended):
    walk.to(State.MOVING)
    assert walk.do(ended, motion_id="old").outcome is Outcome.LATE
    assert walk.case.state is State.MOVING


@pytest.mark.parametrize("guide", [GuideState.WIRE, GuideState.INSTRUMENT, GuideState.UNKNOWN])
def test_something_in_the_guide_of_a_moving_arm_stops_it(walk, guide):
    decision = walk.to(State.MOVING).do(Trigger.GUIDE_STATE_STATED, guide=guide)
    assert decision.row == 35
    assert decision.effects == (Effect.STOP_SENT,)
    assert (walk.case.state, walk.case.plan, walk.case.guide) == (State.SAFE_HOLD, None, guide)


def test_a_sleeve_in_a_moving_arm_stops_it_and_is_unverified(walk):
    decision = walk.to(State.MOVING).do(Trigger.SLEEVE_IN)
    assert decision.effects == (Effect.STOP_SENT,)
    assert walk.case.insertion.status is InsertionStatus.DONE
    assert not walk.case.insertion.verified
    assert walk.do(Trigger.ACKNOWLEDGED).after.state is State.SLEEVE_INSERTED


def test_a_sleeve_is_verified_only_while_the_verification_stands(new_walk):
    walk = new_walk().to(State.SLEEVE_INSERTED)
    assert walk.case.insertion.verified
    moved = new_walk().to(State.INSERTING)
    moved.do(Trigger.PATIENT_MOVED)
    moved.do(Trigger.SLEEVE_IN)
    assert not moved.case.insertion.verified
    assert moved.case.insertion.flagged


def test_a_sleeve_said_to_be_in_again_is_as_verified_as_it_was(new_walk):
    verified = new_walk().to(State.SLEEVE_INSERTED)
    verified.do(Trigger.PATIENT_MOVED)
    verified.do(Trigger.SLEEVE_IN)
    assert verified.case.insertion.verified
    surprising = new_walk().to(State.VERIFIED)
    for trigger in (Trigger.SLEEVE_IN, Trigger.ACKNOWLEDGED, Trigger.SLEEVE_IN):
        surprising.do(trigger)
    assert not surprising.case.insertion.verified


def test_turning_the_carm_away_keeps_a_passed_verification_for_the_insertion(walk):
    walk.to(State.VERIFIED).do(Trigger.CARM_MOVED)
    assert walk.case.state is State.VERIFIED
    assert walk.case.view is None
    walk.do(Trigger.INSERTION_STARTED)
    walk.do(Trigger.SLEEVE_IN)
    assert walk.case.insertion.verified


def test_turning_the_carm_away_does_not_keep_a_failed_one(walk):
    walk.to(State.OFF_TARGET).do(Trigger.CARM_MOVED)
    assert (walk.case.state, walk.case.verification) == (State.CASE_OPEN, None)


def test_the_guide_of_a_running_insertion_is_not_talked_empty(walk):
    decision = walk.to(State.INSERTING).do(Trigger.GUIDE_STATE_STATED)
    assert decision.outcome is Outcome.RECORDED
    assert walk.case.guide is GuideState.INSTRUMENT


def test_a_fault_during_a_hold_is_latched_as_its_cause(walk):
    walk.to(State.MOVING).do(Trigger.STOP)
    assert walk.case.held_for == "stop"
    walk.do(Trigger.FAULT, f.Faulted(f.FaultKind.EMERGENCY_STOP))
    walk.do(Trigger.STOP)
    assert walk.case.held_for == "emergency_stop"
    walk.do(Trigger.ACKNOWLEDGED)
    assert walk.case.held_for is None
