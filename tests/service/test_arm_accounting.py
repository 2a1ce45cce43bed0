"""What no motion accounts for, the pose latched for an exposure, and what the guard's endings amount to."""

import numpy as np
import pytest

from robot.arm import ArmState
from robot.guard.messages import EndCause, FaultKind, MotionEnded
from robot.safety import SafetyState
from service.motion.displacement import DisplacementLedger
from service.motion.exposures import Exposures
from service.motion.outcomes import fault_of, outcome_of
from workflow.triggers import Trigger


def _at(x_mm: float) -> ArmState:
    pose = np.eye(4)
    pose[0, 3] = x_mm
    joints = np.zeros(6)
    return ArmState(
        controller_time_s=0.0,
        received_at_s=0.0,
        joints_rad=joints,
        joint_speeds_rad_s=joints,
        base_from_tcp=pose,
        tcp_speed_mm_s=0.0,
        tcp_turn_speed_rad_s=0.0,
        tcp_force_n=np.zeros(3),
        payload_kg=1.0,
        payload_centre_mm=np.zeros(3),
        safety_bits=1,
        robot_status_bits=1,
        robot_mode=7,
        runtime_state=1,
        program_running=False,
        safety=SafetyState.NORMAL,
    )


def _ended(cause: EndCause) -> MotionEnded:
    return MotionEnded("p", cause, 1.0, True, True, 0.02, 1e-4, _at(0.0), None, "f", 10)


@pytest.mark.hazard("H04")
def test_a_commanded_motion_is_accounted_for_and_a_push_before_and_after_it_is_not() -> None:
    ledger = DisplacementLedger()
    ledger.observe(_at(0.0))
    baseline = ledger.begin_stretch(_at(0.0))
    ledger.start_motion(_at(0.03).base_from_tcp)
    ledger.end_motion(_at(50.0))
    total = ledger.since(baseline, _at(50.04))
    assert total is not None
    assert total.offset_mm == pytest.approx(0.07, abs=1e-9)


def test_what_happened_before_an_exposure_does_not_count_against_it() -> None:
    ledger = DisplacementLedger()
    ledger.observe(_at(0.0))
    baseline = ledger.begin_stretch(_at(5.0))
    total = ledger.since(baseline, _at(5.0))
    assert total is not None
    assert total.offset_mm == 0.0


def test_after_a_motion_that_ended_unseen_nothing_can_be_told_of_an_earlier_exposure() -> None:
    ledger = DisplacementLedger()
    ledger.observe(_at(0.0))
    baseline = ledger.begin_stretch(_at(0.0))
    ledger.start_motion(_at(0.0).base_from_tcp)
    ledger.end_motion(None)
    assert ledger.since(baseline, _at(0.0)) is None


@pytest.mark.hazard("H04")
def test_an_arm_that_moved_and_came_back_during_an_exposure_has_moved() -> None:
    exposures, ledger = Exposures(), DisplacementLedger()
    exposures.open("w", _at(0.0), 0.0, ledger.begin_stretch(_at(0.0)))
    for x_mm in (0.0, 0.2, 0.0):
        exposures.observe(_at(x_mm))
    exposure = exposures.of_window("w")
    assert exposure is not None
    assert exposure.largest.offset_mm == pytest.approx(0.2)


def test_every_end_of_a_motion_but_a_stop_is_an_observation() -> None:
    outcomes = {cause: outcome_of(_ended(cause), "m") for cause in EndCause}
    assert outcomes.pop(EndCause.STOPPED) is None
    assert all(outcome is not None for outcome in outcomes.values())
    calm = {cause for cause, outcome in outcomes.items() if outcome and outcome[0] is not Trigger.FAULT}
    assert calm == {EndCause.ARRIVED, EndCause.MISSED, EndCause.RELEASED}


def test_every_fault_of_the_guard_has_a_word_in_the_rules() -> None:
    assert {fault_of(kind).kind.value for kind in FaultKind} == {kind.value for kind in FaultKind}
