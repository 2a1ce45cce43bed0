"""A case that tests can drive: facts and readings that pass, to be spoilt one at a time."""

import math
from dataclasses import replace
from itertools import count
from typing import Any

import pytest

from workflow import facts as f
from workflow.case import CaseState, opened
from workflow.decisions import Decision
from workflow.limits import Limits
from workflow.machine import decide
from workflow.plans import AIMED, PLAN_INPUTS, PlanKind
from workflow.refusals import Refusal
from workflow.snapshot import Reading, SafetyMode, SafetySnapshot
from workflow.states import GuideState, State
from workflow.triggers import Trigger

JOINTS = (0.1, -1.2, 1.3, -0.4, 1.5, 0.2)
TOKEN = 1


def good_snapshot(**changes: Any) -> SafetySnapshot:
    """Everything as it should be, read 10 ms ago."""
    values = {
        "joints_rad": JOINTS,
        "at_rest": True,
        "safety_mode": SafetyMode.NORMAL,
        "controller_time_s": 1000.0,
        "feedback_advances": True,
        "guard_alive": True,
        "program_running": False,
        "motion_locked": True,
        "image_exposed": True,
        "unaccounted_mm": 0.0,
        "unaccounted_rad": 0.0,
        "drift_mm": 0.0,
        "drift_rad": 0.0,
        "tcp_difference_mm": 0.0,
        "tcp_difference_rad": 0.0,
        "payload_difference_kg": 0.0,
        "devices_hash": "devices",
        "devices_in_date": True,
        "configuration": "configuration",
        "configuration_opened": "configuration",
        "hold_pressed": True,
        "challenge_echoed": True,
        "control_token": TOKEN,
    }
    readings = {name: Reading(value, 0.01) for name, value in values.items()}
    return SafetySnapshot(**{**readings, **changes})


GOOD_QUALITY = f.RegistrationQuality(
    handedness_proved=True,
    plate_required=True,
    plate_balls=400,
    scale_error=0.01,
    fiducials=12,
    residual_rms_px=0.1,
    predicted_angle_rad=math.radians(0.03),
    predicted_position_mm=0.06,
)
SURGEON = f.Approval("surgeon", surgeon=True, pin_confirmed=True, control_token=TOKEN)


def good_facts(case: CaseState, trigger: Trigger, new_id: Any, kind: PlanKind = PlanKind.TARGETING) -> f.Facts:
    """What comes with a trigger when all is well with this very case."""

    def id_of(artefact: Any) -> str:
        return artefact.id if artefact else "none"

    arrived = {"patient_matches": True, "study_matches": True, "sop_uid_unseen": True, "pixels_unseen": True}
    inputs = (case.link(link) for link in PLAN_INPUTS[kind])
    makers = {
        f.CarmPositionConfirmed: lambda: f.CarmPositionConfirmed(new_id("view")),
        f.ExposureRequested: lambda: f.ExposureRequested(new_id("window")),
        f.ImageArrived: lambda: f.ImageArrived(
            new_id("image"), **arrived, newer_by_carm_clock=True, moved_mm=0.0, moved_rad=0.0
        ),
        f.NewestImageReused: lambda: f.NewestImageReused(case.newest_image_id or "none", guide_in_image=True),
        f.RegistrationCompleted: lambda: f.RegistrationCompleted(
            new_id("registration"), id_of(case.image), GOOD_QUALITY
        ),
        f.RegistrationRefused: lambda: f.RegistrationRefused(id_of(case.image), "ring_missing"),
        f.Reasoned: lambda: f.Reasoned("because"),
        f.TargetConfirmed: lambda: f.TargetConfirmed(
            new_id("target"), id_of(case.image), id_of(case.registration), echo_seen=True
        ),
        f.PlanRequested: lambda: f.PlanRequested(
            plan_id=new_id("plan"),
            kind=kind,
            axial=kind is PlanKind.RETREAT,
            made_from=tuple(id_of(artefact) for artefact in inputs),
            start_joints_rad=JOINTS,
            length_mm=100.0,
            rotation_rad=0.3,
            speed_mm_s=20.0,
            speed_rad_s=math.radians(5.0),
            acceleration_mm_s2=50.0,
            joint_margin_rad=1.0,
            smallest_singular_value=0.2,
            clearance_mm=20.0,
            clearance_needed_mm=5.0,
            predicted_angle_rad=math.radians(0.05) if kind in AIMED else None,
            predicted_position_mm=0.1 if kind in AIMED else None,
        ),
        f.MoveApproved: lambda: f.MoveApproved(new_id("permit"), id_of(case.plan), SURGEON),
        f.MoveStarted: lambda: f.MoveStarted(new_id("motion"), id_of(case.permit), TOKEN),
        f.MotionEnded: lambda: f.MotionEnded(id_of(case.running), at_rest=True, distance_mm=0.02, angle_rad=1e-5),
        f.Evaluated: lambda: f.Evaluated(
            new_id("evaluation"),
            id_of(case.evaluated_image),
            angle_error_rad=math.radians(0.5 if trigger is Trigger.VERIFICATION_PASSED else 2.0),
            angle_bound_rad=math.radians(0.1),
            position_error_mm=0.5 if trigger is Trigger.VERIFICATION_PASSED else 3.0,
            position_bound_mm=0.1,
            agree=True,
            motion_chi_square=6.0,
            anatomy_across_mm=0.1,
            anatomy_along_mm=0.4,
        ),
        f.VerificationRefused: lambda: f.VerificationRefused(id_of(case.evaluated_image), "guide_cut_off"),
        f.CorrectionRequested: lambda: f.CorrectionRequested(
            image_id=case.verification.image_id if case.verification else "none",
            registration_id=new_id("registration"),
            target_id=new_id("target"),
            quality=GOOD_QUALITY,
            reason="",
        ),
        f.InsertionStarted: lambda: f.InsertionStarted(new_id("insertion"), SURGEON),
        f.SleeveIn: lambda: f.SleeveIn(new_id("insertion")),
        f.GuideStated: lambda: f.GuideStated(GuideState.EMPTY),
        f.TargetDone: lambda: f.TargetDone(placed=True, reason=""),
        f.Movement: lambda: f.Movement(observed=False, what="turned away"),
        f.Stopped: lambda: f.Stopped("anyone"),
        f.Faulted: lambda: f.Faulted(f.FaultKind.PROTECTIVE_STOP),
        f.Restarted: f.Restarted,
        f.Acknowledged: lambda: f.Acknowledged(surgeon=True, guide=case.guide),
        f.LeaseTaken: lambda: f.LeaseTaken(TOKEN, "shift change"),
        f.CaseClosed: lambda: f.CaseClosed(open_targets=0),
        f.Paper: lambda: f.Paper(permitted=True),
    }
    return makers[f.FACTS_OF[trigger]]()


# How a case gets to each state when all goes well.
_AIMED = [Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED]
_STEPS = [
    (State.CASE_OPEN, [Trigger.GUIDE_STATE_STATED]),
    (State.CARM_POSITIONED, [Trigger.CARM_POSITION_CONFIRMED, Trigger.EXPOSURE_REQUESTED]),
    (State.IMAGE_ACQUIRED, [Trigger.IMAGE_ARRIVED]),
    (State.REGISTERED, [Trigger.REGISTRATION_COMPLETED]),
    (State.TARGET_CHOSEN, [Trigger.TARGET_CONFIRMED, *_AIMED]),
    (State.MOVING, [Trigger.MOVE_STARTED]),
    (State.MOVED, [Trigger.ARRIVED, Trigger.EXPOSURE_REQUESTED, Trigger.IMAGE_ARRIVED]),
    (State.VERIFIED, [Trigger.VERIFICATION_PASSED]),
    (State.INSERTING, [Trigger.INSERTION_STARTED]),
    (State.SLEEVE_INSERTED, [Trigger.SLEEVE_IN]),
]
_ASIDE = {
    State.OFF_TARGET: (State.MOVED, Trigger.VERIFICATION_FAILED),
    State.SAFE_HOLD: (State.REGISTERED, Trigger.HOLD_REQUESTED),
    State.CLOSED: (State.REGISTERED, Trigger.CASE_CLOSED),
    State.ABORTED: (State.REGISTERED, Trigger.CASE_ABORTED),
}


class Walk:
    """A case on its way, with a clock and ids of its own."""

    def __init__(self) -> None:
        self.case = opened("case")
        self.now_s = 100.0
        self.limits = Limits(motion_chi_square=18.5)
        self.snapshot = good_snapshot()
        self._numbers = count(1)

    def new_id(self, what: str) -> str:
        return f"{what}-{next(self._numbers)}"

    def facts(self, trigger: Trigger, *, kind: PlanKind = PlanKind.TARGETING, **changes: Any) -> f.Facts:
        return replace(good_facts(self.case, trigger, self.new_id, kind), **changes)

    def ask(self, trigger: Trigger, facts: f.Facts | None = None, **changes: Any) -> Decision | Refusal:
        """Fire a trigger and keep what became of the case."""
        given = facts if facts is not None else self.facts(trigger, **changes)
        answer = decide(self.case, trigger, given, self.snapshot, self.limits, self.now_s)
        if isinstance(answer, Decision):
            self.case = answer.after
        return answer

    def do(self, trigger: Trigger, facts: f.Facts | None = None, **changes: Any) -> Decision:
        """The same, where it must be taken."""
        answer = self.ask(trigger, facts, **changes)
        assert isinstance(answer, Decision), answer
        return answer

    def refused(self, trigger: Trigger, facts: f.Facts | None = None, **changes: Any) -> Refusal:
        """The same, where it must be refused and nothing may change."""
        before = self.case
        answer = self.ask(trigger, facts, **changes)
        assert isinstance(answer, Refusal), answer
        assert self.case == before
        assert answer.leads_onwards
        return answer

    def spoil(self, **readings: Any) -> None:
        """Replace readings of the snapshot."""
        self.snapshot = replace(self.snapshot, **readings)

    def to(self, state: State) -> "Walk":
        """Go to a state the usual way."""
        if state in _ASIDE:
            before, trigger = _ASIDE[state]
            self.to(before).do(trigger)
            return self
        for reached, triggers in _STEPS:
            for trigger in triggers:
                self.do(trigger)
            if reached is state:
                break
        assert self.case.state is state
        return self


@pytest.fixture
def walk() -> Walk:
    return Walk()


@pytest.fixture(scope="session")
def new_walk() -> type[Walk]:
    return Walk


@pytest.fixture(scope="session")
def snapshot_of() -> Any:
    return good_snapshot


@pytest.fixture(scope="session")
def facts_of() -> Any:
    return good_facts
