"""Each interlock alone: what passes at its limit, what refuses beyond it, and what is unknown, stale or no number."""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import pytest

from workflow import facts as f
from workflow import interlocks, machine
from workflow.case import CaseState, Insertion
from workflow.decisions import Decision
from workflow.interlocks import INTERLOCKS
from workflow.limits import Limits
from workflow.plans import PlanKind
from workflow.refusals import Refusal
from workflow.snapshot import Reading, SafetyMode
from workflow.states import GuideState, InsertionStatus, State
from workflow.triggers import REQUESTS, Trigger

LIMITS = Limits()
NAN = math.nan
UNKNOWN = Reading(None, 0.01)
ELSEWHERE = (9.0, -1.2, 1.3, -0.4, 1.5, 0.2)
# Just beyond a limit, relatively: far above rounding, far below anything that matters.
MORE = 1.0 + 1e-6


@dataclass(frozen=True)
class Spoil:
    """One thing that is different from a case in which all is well."""

    readings: dict[str, Reading] = field(default_factory=dict)
    facts: dict[str, Any] = field(default_factory=dict)
    quality: dict[str, Any] = field(default_factory=dict)
    later_s: float = 0.0
    case: Callable[[CaseState], CaseState] = lambda case: case


@dataclass(frozen=True)
class Proof:
    """Where an interlock is met, what it lets pass and what it refuses."""

    state: State
    trigger: Trigger
    refusing: list[Spoil]
    passing: list[Spoil]
    kind: PlanKind = PlanKind.TARGETING


def reading(name: str, value: Any, age_s: float = 0.01) -> Spoil:
    return Spoil(readings={name: Reading(value, age_s)})


def given(**facts: Any) -> Spoil:
    return Spoil(facts=facts)


def of_quality(**quality: Any) -> Spoil:
    return Spoil(quality=quality)


def surgery(**changes: Any) -> Spoil:
    """A case that no trigger can make: the interlock is the second line behind the voiding."""
    return Spoil(case=lambda case: replace(case, **changes))


def nested(link: str, **changes: Any) -> Spoil:
    return Spoil(case=lambda case: replace(case, **{link: replace(getattr(case, link), **changes)}))


def said(name: str, value: bool, age_s: float) -> tuple[list[Spoil], list[Spoil]]:
    """A reading that must say something: the opposite, unknown, stale, from the future or of no age refuse."""
    wrong = [(not value, 0.01), (None, 0.01), (value, age_s * MORE), (value, -0.01), (value, NAN)]
    return [reading(name, *bad) for bad in wrong], [reading(name, value, age_s)]


def measured(name: str, limit: float, age_s: float) -> tuple[list[Spoil], list[Spoil]]:
    """A reading with a limit: beyond it, negative, unknown, stale or no number refuse."""
    wrong = [(limit * MORE, 0.01), (-0.01, 0.01), (None, 0.01), (NAN, 0.01), (0.0, age_s * MORE), (0.0, NAN)]
    return [reading(name, *bad) for bad in wrong], [reading(name, limit), reading(name, 0.0, age_s)]


def stated(name: str) -> tuple[list[Spoil], list[Spoil]]:
    return [given(**{name: False}), given(**{name: None})], [given(**{name: True})]


def most(make: Callable[..., Spoil], name: str, limit: float) -> tuple[list[Spoil], list[Spoil]]:
    return [make(**{name: bad}) for bad in (limit * MORE, -0.01, None, NAN, math.inf)], [make(**{name: limit})]


def least(name: str, limit: float) -> tuple[list[Spoil], list[Spoil]]:
    return [given(**{name: bad}) for bad in (limit / MORE, -1.0, None, NAN)], [given(**{name: limit})]


FEEDBACK, HEARTBEAT, RECORD = LIMITS.feedback_age_s, LIMITS.heartbeat_age_s, LIMITS.record_age_s
OTHER = f.Approval("surgeon", surgeon=True, pin_confirmed=True, control_token=1)
REGISTER = (State.IMAGE_ACQUIRED, Trigger.REGISTRATION_COMPLETED)
ARRIVE = (State.CARM_POSITIONED, Trigger.IMAGE_ARRIVED)
APPROVE = (State.TARGET_CHOSEN, Trigger.MOVE_APPROVED)
START = (State.TARGET_CHOSEN, Trigger.MOVE_STARTED)
JUDGE = (State.MOVED, Trigger.VERIFICATION_PASSED)
INSERT = (State.VERIFIED, Trigger.INSERTION_STARTED)
TARGET = (State.REGISTERED, Trigger.TARGET_CONFIRMED)
PLAN = (State.TARGET_CHOSEN, Trigger.PLAN_REQUESTED)
ACKNOWLEDGE = (State.SAFE_HOLD, Trigger.ACKNOWLEDGED)
SLEEVE = Insertion("insertion", InsertionStatus.OPEN, verified=True, flagged=False)
ANGLE_LEFT = LIMITS.angle_error_rad - math.radians(0.1)  # beside the bound that the usual facts carry
POSITION_LEFT = LIMITS.position_error_mm - 0.1

PROOFS: dict[str, Proof] = {
    "patient_matches": Proof(*ARRIVE, *stated("patient_matches")),
    "study_matches": Proof(*ARRIVE, *stated("study_matches")),
    "image_unseen": Proof(*ARRIVE, *stated("sop_uid_unseen")),
    "pixels_unseen": Proof(*ARRIVE, *stated("pixels_unseen")),
    "image_newer": Proof(*ARRIVE, *stated("newer_by_carm_clock")),
    "window_open": Proof(*ARRIVE, [Spoil(later_s=120.001), surgery(window=None)], [Spoil(later_s=120.0)]),
    "still_mm": Proof(*ARRIVE, *most(given, "moved_mm", 0.05)),
    "still_rad": Proof(*ARRIVE, *most(given, "moved_rad", math.radians(0.02))),
    "image_after_motion": Proof(
        State.MOVED, Trigger.IMAGE_ARRIVED, [nested("window", motion_id="old"), nested("window", motion_id=None)], []
    ),
    "newest_image": Proof(
        State.CARM_POSITIONED, Trigger.NEWEST_IMAGE_REUSED, [given(image_id="old"), surgery(newest_image_id=None)], []
    ),
    "guide_in_image": Proof(State.CARM_POSITIONED, Trigger.NEWEST_IMAGE_REUSED, *stated("guide_in_image")),
    "handedness": Proof(
        *REGISTER, [of_quality(handedness_proved=False), of_quality(handedness_proved=None)], [of_quality()]
    ),
    "plate": Proof(
        *REGISTER,
        [of_quality(plate_balls=39), of_quality(plate_balls=None), of_quality(plate_required=None)],
        [of_quality(plate_balls=40), of_quality(plate_required=False, plate_balls=0)],
    ),
    "scale": Proof(*REGISTER, *most(of_quality, "scale_error", 0.1)),
    "fiducials": Proof(*REGISTER, [of_quality(fiducials=11), of_quality(fiducials=None)], [of_quality(fiducials=12)]),
    "residual": Proof(*REGISTER, *most(of_quality, "residual_rms_px", 1.0)),
    "predicted_angle": Proof(*REGISTER, *most(of_quality, "predicted_angle_rad", math.radians(1.0))),
    "predicted_position": Proof(*REGISTER, *most(of_quality, "predicted_position_mm", 1.5)),
    "image_age": Proof(
        *START,
        [reading("image_exposed", True, age_s) for age_s in (1800.0 * MORE, -0.01, NAN, math.inf)],
        [reading("image_exposed", True, 1800.0)],
    ),
    "target_echo": Proof(*TARGET, *stated("echo_seen")),
    "target_image": Proof(*TARGET, [given(image_id="old")], []),
    "target_registration": Proof(*TARGET, [given(registration_id="old")], []),
    "plan_plausible": Proof(
        *PLAN,
        [given(start_joints_rad=(57.3,) * 6), given(start_joints_rad=(NAN,) * 6)],
        [given(start_joints_rad=(2.0 * math.pi,) * 6)],
    ),
    "joint_margin": Proof(*PLAN, *least("joint_margin_rad", math.radians(5.0))),
    "singularity": Proof(*PLAN, *least("smallest_singular_value", 0.05)),
    "clearance": Proof(
        *PLAN,
        [
            *least("clearance_mm", 5.0)[0],
            given(clearance_needed_mm=None),
            given(clearance_needed_mm=20.0 * MORE),
            given(clearance_mm=1.9, clearance_needed_mm=1.0),  # the room file may not ask for as little
        ],
        [given(clearance_mm=5.0), given(clearance_mm=-3.0, clearance_needed_mm=-3.0, axial=True)],
    ),
    "path_length": Proof(*PLAN, *most(given, "length_mm", 150.0)),
    "path_angle": Proof(*PLAN, *most(given, "rotation_rad", math.radians(35.0))),
    "path_speed": Proof(*PLAN, *most(given, "speed_mm_s", 20.0)),
    "path_turn_speed": Proof(*PLAN, *most(given, "speed_rad_s", math.radians(5.0))),
    "path_acceleration": Proof(*PLAN, *most(given, "acceleration_mm_s2", 50.0)),
    "aim_angle": Proof(
        *START,
        [nested("plan", predicted_angle_rad=bad) for bad in (math.radians(0.25) * MORE, None, NAN, -0.01)],
        [nested("plan", predicted_angle_rad=math.radians(0.25))],
    ),
    "aim_position": Proof(
        *START,
        [nested("plan", predicted_position_mm=bad) for bad in (0.5 * MORE, None, NAN, -0.01)],
        [nested("plan", predicted_position_mm=0.5)],
    ),
    "plan_parents": Proof(*PLAN, [given(made_from=("old",)), given(made_from=())], []),
    "plan_current": Proof(*APPROVE, [given(plan_id="old")], []),
    "surgeon": Proof(*APPROVE, [given(approval=replace(OTHER, surgeon=False))], []),
    "pin": Proof(*APPROVE, [given(approval=replace(OTHER, pin_confirmed=False))], []),
    "lease": Proof(
        *APPROVE,
        [given(approval=replace(OTHER, control_token=2)), reading("control_token", 2), reading("control_token", None)],
        [reading("control_token", 1, RECORD)],
    ),
    "devices_known": Proof(
        *APPROVE,
        [reading("devices_hash", None), reading("devices_hash", "devices", RECORD * MORE)],
        [reading("devices_hash", "devices", RECORD)],
    ),
    "arm_where_planned": Proof(
        *APPROVE,
        [reading("joints_rad", ELSEWHERE), reading("joints_rad", ())],
        [],
    ),
    "permit_current": Proof(*START, [given(permit_id="foreign")], []),
    "permit_unused": Proof(
        *START, [Spoil(case=lambda case: replace(case, used_permit_id=case.permit and case.permit.id))], []
    ),
    "permit_fresh": Proof(*START, [Spoil(later_s=30.001), Spoil(later_s=-1.0)], [Spoil(later_s=30.0)]),
    "permit_holder": Proof(
        *START, [Spoil(readings={"control_token": Reading(2, 0.01)}, facts={"control_token": 2})], []
    ),
    "permit_parents": Proof(*START, [nested("permit", made_from=("old",)), nested("target", id="new")], []),
    "permit_joints": Proof(*START, [reading("joints_rad", ELSEWHERE), reading("joints_rad", ELSEWHERE[:5])], []),
    "permit_devices": Proof(*START, [reading("devices_hash", "others"), reading("devices_hash", None)], []),
    "permit_guide": Proof(*START, [surgery(guide=GuideState.WIRE)], [], PlanKind.RETREAT),
    "guide_empty": Proof(
        *APPROVE,
        [surgery(guide=guide) for guide in (GuideState.WIRE, GuideState.INSTRUMENT, GuideState.UNKNOWN)],
        [surgery(guide=GuideState.EMPTY)],
    ),
    "guide_known": Proof(
        State.CARM_POSITIONED, Trigger.EXPOSURE_REQUESTED, [surgery(guide=GuideState.UNKNOWN)], [given()]
    ),
    "guide_restated": Proof(*ACKNOWLEDGE, [given(guide=GuideState.WIRE)], []),
    "no_insertion": Proof(*APPROVE, [surgery(insertion=SLEEVE)], []),
    "at_rest": Proof(State.CARM_POSITIONED, Trigger.EXPOSURE_REQUESTED, *said("at_rest", True, FEEDBACK)),
    "unaccounted_mm": Proof(*START, *measured("unaccounted_mm", 0.05, FEEDBACK)),
    "unaccounted_rad": Proof(*START, *measured("unaccounted_rad", math.radians(0.02), FEEDBACK)),
    "devices_in_date": Proof(*START, *said("devices_in_date", True, RECORD)),
    "tcp_mm": Proof(*START, *measured("tcp_difference_mm", 5.0, RECORD)),
    "tcp_rad": Proof(*START, *measured("tcp_difference_rad", math.radians(1.0), RECORD)),
    "payload_kg": Proof(*START, *measured("payload_difference_kg", LIMITS.payload_difference_kg, RECORD)),
    "configuration": Proof(
        *PLAN,
        [
            reading("configuration", "another"),
            reading("configuration", None),
            reading("configuration_opened", None),
            Spoil(readings={"configuration": UNKNOWN, "configuration_opened": UNKNOWN}),
            reading("configuration", "configuration", RECORD * MORE),
        ],
        [reading("configuration", "configuration", RECORD)],
    ),
    "hold_pressed": Proof(*START, [reading("hold_pressed", False), reading("hold_pressed", None)], []),
    "heartbeat_fresh": Proof(
        *START, [reading("hold_pressed", True, 0.2001)], [reading("hold_pressed", True, HEARTBEAT)]
    ),
    "challenge_echoed": Proof(*START, [reading("challenge_echoed", False), reading("challenge_echoed", None)], []),
    "challenge_fresh": Proof(
        *START, [reading("challenge_echoed", True, 0.2001)], [reading("challenge_echoed", True, HEARTBEAT)]
    ),
    "guard_alive": Proof(*START, *said("guard_alive", True, HEARTBEAT)),
    "safety_normal": Proof(
        *START,
        [reading("safety_mode", mode) for mode in SafetyMode if mode not in (SafetyMode.NORMAL, SafetyMode.REDUCED)]
        + [reading("safety_mode", None), reading("safety_mode", SafetyMode.NORMAL, FEEDBACK * MORE)],
        [reading("safety_mode", SafetyMode.REDUCED, FEEDBACK)],
    ),
    "feedback_fresh": Proof(
        *START, [reading("controller_time_s", 1.0, 0.1001)], [reading("controller_time_s", 1.0, FEEDBACK)]
    ),
    "joints_fresh": Proof(*ACKNOWLEDGE, [reading("joints_rad", ELSEWHERE, 0.1001)], [reading("joints_rad", ELSEWHERE)]),
    "feedback_finite": Proof(
        *ACKNOWLEDGE,
        [
            reading("controller_time_s", NAN),
            reading("controller_time_s", None),
            reading("joints_rad", (NAN, *ELSEWHERE[1:])),
            reading("joints_rad", None),
        ],
        [reading("joints_rad", ELSEWHERE)],
    ),
    "feedback_advances": Proof(*START, *said("feedback_advances", True, FEEDBACK)),
    "figures_plausible": Proof(
        *JUDGE,
        [
            given(angle_error_rad=0.5 * 57.3),
            given(angle_error_rad=None),
            given(angle_bound_rad=NAN),
            given(position_error_mm=500.0),
            given(position_error_mm=NAN),
            given(position_bound_mm=-0.1),
        ],
        [given(angle_error_rad=0.0)],
    ),
    "image_evaluated": Proof(*JUDGE, [given(image_id="old")], []),
    "evaluations_agree": Proof(*JUDGE, *stated("agree")),
    "motion_agrees": Proof(*JUDGE, *most(given, "motion_chi_square", 18.548)),
    "anatomy_across": Proof(*JUDGE, *most(given, "anatomy_across_mm", 0.5)),
    "anatomy_along": Proof(*JUDGE, *most(given, "anatomy_along_mm", 2.0)),
    "angle_error": Proof(*JUDGE, [given(angle_error_rad=ANGLE_LEFT * MORE)], [given(angle_error_rad=ANGLE_LEFT)]),
    "position_error": Proof(
        *JUDGE, [given(position_error_mm=POSITION_LEFT * MORE)], [given(position_error_mm=POSITION_LEFT)]
    ),
    "correction_image": Proof(State.OFF_TARGET, Trigger.CORRECTION_REQUESTED, [given(image_id="old")], []),
    "verification_newer": Proof(
        *INSERT, [nested("verification", motion_id="old"), nested("verification", passed=False)], [surgery(motion=None)]
    ),
    "verification_age": Proof(*INSERT, [Spoil(later_s=900.1), Spoil(later_s=-1.0)], [Spoil(later_s=900.0)]),
    "script_stopped": Proof(*INSERT, *said("program_running", False, FEEDBACK)),
    "motion_locked": Proof(*INSERT, *said("motion_locked", True, HEARTBEAT)),
    "drift_mm": Proof(*INSERT, *measured("drift_mm", 0.3, FEEDBACK)),
    "drift_rad": Proof(*INSERT, *measured("drift_rad", math.radians(0.1), FEEDBACK)),
}
REFUSING = [(code, at) for code, proof in PROOFS.items() for at in range(len(proof.refusing))]
PASSING = [(code, at) for code, proof in PROOFS.items() for at in range(len(proof.passing))]


def prepared(walk, proof: Proof):
    """The usual case, one step before the trigger."""
    walk.to(proof.state)
    if proof.trigger is Trigger.NEWEST_IMAGE_REUSED:
        walk.do(Trigger.IMAGE_ARRIVED)
        walk.do(Trigger.RETAKE)
    if proof.trigger is Trigger.IMAGE_ARRIVED and proof.state is State.MOVED:
        walk.do(Trigger.EXPOSURE_REQUESTED)
    if proof.kind is PlanKind.RETREAT:
        walk.do(Trigger.PLAN_REQUESTED, kind=proof.kind)
        walk.do(Trigger.MOVE_APPROVED)
    return walk


def spoilt(walk, proof: Proof, spoil: Spoil):
    """Ask with one thing different."""
    facts = walk.facts(proof.trigger, **spoil.facts)
    if spoil.quality:
        facts = replace(facts, quality=replace(facts.quality, **spoil.quality))
    walk.case = spoil.case(walk.case)
    walk.now_s += spoil.later_s
    walk.spoil(**spoil.readings)
    return walk.ask(proof.trigger, facts)


def failed(answer) -> set[str]:
    return {verdict.code for verdict in answer.verdicts if not verdict.passed}


def usual_row(new_walk, proof: Proof) -> int | None:
    answer = spoilt(prepared(new_walk(), proof), proof, Spoil())
    assert isinstance(answer, Decision), answer
    assert not failed(answer)
    return answer.row


@pytest.mark.parametrize(("code", "at"), REFUSING)
def test_it_refuses_and_names_its_hazard(new_walk, code, at):
    proof = PROOFS[code]
    row = usual_row(new_walk, proof)
    answer = spoilt(prepared(new_walk(), proof), proof, proof.refusing[at])
    assert isinstance(answer, Refusal) or answer.row != row
    assert code in failed(answer)
    verdict = next(verdict for verdict in answer.verdicts if verdict.code == code)
    assert verdict.hazard == INTERLOCKS[code].hazard
    assert verdict.message
    assert json.dumps([verdict.measured, verdict.limit], allow_nan=False)


@pytest.mark.parametrize(("code", "at"), PASSING)
def test_it_passes_at_its_limit(new_walk, code, at):
    proof = PROOFS[code]
    answer = spoilt(prepared(new_walk(), proof), proof, proof.passing[at])
    assert isinstance(answer, Decision), answer
    assert answer.row == usual_row(new_walk, proof)
    assert not failed(answer)


@pytest.mark.parametrize("code", sorted(INTERLOCKS))
def test_without_it_its_own_test_would_fail(new_walk, monkeypatch, code):
    """Each interlock alone refuses one of its proofs: taken out, that very request is taken."""
    proof = PROOFS[code]
    row = usual_row(new_walk, proof)
    alone = [at for at, spoil in enumerate(proof.refusing) if refused_by(new_walk, proof, spoil) == {code}]
    assert alone, "no proof fails for this interlock alone"
    take_out(monkeypatch, code)
    answer = spoilt(prepared(new_walk(), proof), proof, proof.refusing[alone[-1]])
    assert isinstance(answer, Decision)
    assert answer.row == row or code == "image_evaluated"  # of another image: late even without the verdict
    assert code not in {verdict.code for verdict in answer.verdicts}


def refused_by(new_walk, proof: Proof, spoil: Spoil) -> set[str]:
    return failed(spoilt(prepared(new_walk(), proof), proof, spoil))


def take_out(monkeypatch, code: str) -> None:
    required = interlocks.required
    monkeypatch.setattr(
        interlocks, "required", lambda inquiry: tuple(lock for lock in required(inquiry) if lock.code != code)
    )


def test_every_interlock_has_a_proof_and_every_hazard_an_interlock():
    assert set(PROOFS) == set(INTERLOCKS)
    enforced = {lock.hazard for lock in INTERLOCKS.values()}
    here = "01 02 03 04 05 06 07 08 09 10 11 12 13 14 15 16 17 18 21 22 28 29 30 33 34 35 36"
    assert enforced == {f"H{number}" for number in here.split()}


@pytest.mark.hazard("H03")
@pytest.mark.parametrize(
    ("state", "trigger"),
    [
        TARGET,
        PLAN,
        APPROVE,
        START,
        (State.MOVED, Trigger.TARGET_CONFIRMED),
        (State.OFF_TARGET, Trigger.CORRECTION_REQUESTED),
    ],
)
def test_nothing_is_aimed_with_an_old_image(new_walk, state, trigger):
    """H03: half an hour after the exposure nobody knows whether the C-arm still stands."""
    walk = new_walk().to(state)
    walk.spoil(image_exposed=Reading(True, 1801.0))
    refusal = walk.refused(trigger)
    assert [(one.code, one.hazard, one.measured, one.limit) for one in refusal.failed] == [
        ("image_age", "H03", 1801.0, 1800.0)
    ]


def test_an_old_image_does_not_keep_the_arm_from_retreating(new_walk):
    walk = new_walk().to(State.TARGET_CHOSEN)
    walk.spoil(image_exposed=Reading(None, math.inf))
    walk.do(Trigger.PLAN_REQUESTED, kind=PlanKind.RETREAT)
    walk.do(Trigger.MOVE_APPROVED)
    walk.do(Trigger.MOVE_STARTED)


def test_nothing_passes_when_nothing_is_known(new_walk):
    for trigger in (Trigger.EXPOSURE_REQUESTED, Trigger.CARM_POSITION_CONFIRMED):
        walk = new_walk().to(State.CARM_POSITIONED)
        answer = machine.decide(walk.case, trigger, walk.facts(trigger), None, LIMITS, 0.0)
        assert isinstance(answer, Refusal)
        assert not any(verdict.passed for verdict in answer.verdicts if verdict.code != "guide_known")


CHANGED = {"configuration": Reading("changed", 0.01)}
STILL_ALLOWED = {
    Trigger.STOP,
    Trigger.HOLD_REQUESTED,
    Trigger.ACKNOWLEDGED,
    Trigger.LEASE_TAKEN,
    Trigger.TARGET_DONE,
    Trigger.CASE_CLOSED,
    Trigger.NOTE,
    Trigger.LABEL,
    Trigger.READ,
    Trigger.EXPORT,
}


@pytest.mark.hazard("H30")
@pytest.mark.parametrize("trigger", REQUESTS)
@pytest.mark.parametrize("state", State)
def test_under_another_configuration_a_case_goes_no_further(new_walk, state, trigger):
    """H30: only stop, words and what leads to a retreat or to the end of the case are judged as ever."""
    walk = new_walk().to(state)
    facts = walk.facts(trigger)
    usual = new_walk().to(state).ask(trigger, facts)
    walk.spoil(**CHANGED)
    answer = walk.ask(trigger, facts)
    if trigger in STILL_ALLOWED:
        assert type(answer) is type(usual)
        assert "configuration" not in failed(answer)
    else:
        assert isinstance(answer, Refusal)
        assert "configuration" in failed(answer)


def test_under_another_configuration_the_arm_still_retreats_and_the_case_closes(new_walk):
    walk = new_walk().to(State.VERIFIED)
    walk.spoil(**CHANGED)
    walk.do(Trigger.RESTARTED)
    walk.do(Trigger.GUIDE_STATE_STATED)
    walk.do(Trigger.ACKNOWLEDGED)
    for trigger in (Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED):
        walk.do(trigger, kind=PlanKind.RETREAT)
    walk.do(Trigger.ARRIVED)
    refusal = walk.refused(Trigger.PLAN_REQUESTED, kind=PlanKind.APPROACH)
    assert [(one.code, one.hazard, one.measured, one.limit) for one in refusal.failed] == [
        ("configuration", "H30", "changed", "configuratio")
    ]
    walk.do(Trigger.CASE_CLOSED)


def test_a_retreat_that_was_planned_lets_nothing_else_past(new_walk):
    walk = new_walk().to(State.REGISTERED)
    walk.do(Trigger.PLAN_REQUESTED, kind=PlanKind.RETREAT)
    walk.spoil(**CHANGED)
    assert "configuration" in failed(walk.refused(Trigger.TARGET_CONFIRMED))
