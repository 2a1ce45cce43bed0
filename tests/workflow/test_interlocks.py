"""Each interlock alone: what passes at its limit, what refuses beyond it, and what is unknown, stale or no number."""

import json
import math
from dataclasses import replace

import pytest

from tests.workflow.conftest import GOOD_QUALITY
from tests.workflow.proof import LIMITS, Proof, Spoil, failed
from tests.workflow.proofs_of_arm import ARM_PROOFS
from tests.workflow.proofs_of_images import IMAGE_PROOFS
from tests.workflow.proofs_of_plans import PLAN_PROOFS
from workflow import interlocks, machine
from workflow.decisions import Decision
from workflow.inquiry import Inquiry
from workflow.interlocks import INTERLOCKS
from workflow.plans import PlanKind
from workflow.refusals import Refusal
from workflow.snapshot import Reading, unknown_snapshot
from workflow.states import State
from workflow.triggers import Trigger

PROOFS: dict[str, Proof] = IMAGE_PROOFS | PLAN_PROOFS | ARM_PROOFS
REFUSING = [(code, at) for code, proof in PROOFS.items() for at in range(len(proof.refusing))]
# What the case itself tells needs neither the room nor what comes with a request.
OF_THE_CASE_ALONE = {
    *("aim_angle", "aim_position", "guide_empty", "guide_known", "image_after_motion", "no_insertion"),
    *("permit_fresh", "permit_guide", "permit_parents", "verification_age", "verification_newer", "window_open"),
}
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


def test_nothing_passes_when_nothing_is_known(new_walk):
    for trigger in (Trigger.EXPOSURE_REQUESTED, Trigger.CARM_POSITION_CONFIRMED):
        walk = new_walk().to(State.CARM_POSITIONED)
        answer = machine.decide(walk.case, trigger, walk.facts(trigger), None, LIMITS, 0.0)
        assert isinstance(answer, Refusal)
        assert not any(verdict.passed for verdict in answer.verdicts if verdict.code != "guide_known")


@pytest.mark.parametrize("code", sorted(INTERLOCKS))
def test_what_nobody_said_is_refused(new_walk, code):
    """Each fails closed where nothing came with the request and nothing is known of the room."""
    walk, lock = prepared(new_walk(), PROOFS[code]), INTERLOCKS[code]
    verdict = lock.judge(Inquiry(walk.case, PROOFS[code].trigger, None, unknown_snapshot(), LIMITS, walk.now_s))
    assert verdict.passed == (code in OF_THE_CASE_ALONE)


@pytest.mark.parametrize(
    ("reading", "note"),
    [
        (Reading(None, 0.01), "unknown"),
        (Reading(math.nan, 0.01), "not a finite number"),
        (Reading(0.0, 0.2), "the reading is 0.2 s old, at most 0.1 s count"),
        (Reading(None, 0.2), "the reading is 0.2 s old, at most 0.1 s count"),
        (Reading(0.0, 0.0), ""),
        (Reading(1.0, 0.0), ""),
    ],
)
def test_a_verdict_says_why_nothing_was_measured(walk, reading, note):
    walk.to(State.VERIFIED).spoil(drift_mm=reading)
    answer = walk.ask(Trigger.INSERTION_STARTED)
    drift = next(verdict for verdict in answer.verdicts if verdict.code == "drift_mm")
    told = "; ".join(part for part in (INTERLOCKS["drift_mm"].message, note) if part)
    assert drift.message == ("" if drift.passed else told)


def test_joints_that_cannot_be_compared_are_no_number(walk):
    walk.to(State.TARGET_CHOSEN).spoil(joints_rad=Reading((0.1, 0.2), 0.01))
    answer = walk.refused(Trigger.MOVE_STARTED)
    notes = {verdict.code: verdict.message for verdict in answer.failed}
    assert notes["permit_joints"].endswith("not a finite number")
    walk.spoil(joints_rad=Reading(None, 0.01))
    notes = {verdict.code: verdict.message for verdict in walk.refused(Trigger.MOVE_STARTED).failed}
    assert notes["permit_joints"].endswith("unknown")


@pytest.mark.parametrize(
    ("state", "trigger", "spoil", "code"),
    [
        (State.TARGET_CHOSEN, Trigger.PLAN_REQUESTED, Spoil(facts={"joint_margin_rad": None}), "joint_margin"),
        (State.TARGET_CHOSEN, Trigger.MOVE_STARTED, Spoil(readings={"at_rest": Reading(None, 0.01)}), "at_rest"),
    ],
)
def test_what_is_unknown_is_said_to_be(walk, state, trigger, spoil, code):
    refusal = spoilt(walk.to(state), Proof(state, trigger, [], []), spoil)
    messages = {verdict.code: verdict.message for verdict in refusal.failed}
    assert messages[code].endswith("; unknown")


@pytest.mark.parametrize("name", ["configuration", "configuration_opened"])
def test_a_configuration_that_was_not_read_again_says_how_old_it_is(walk, name):
    walk.to(State.TARGET_CHOSEN).spoil(**{name: Reading("configuration", 2.1)})
    (verdict,) = walk.refused(Trigger.PLAN_REQUESTED).failed
    assert verdict.message.endswith("the reading is 2.1 s old, at most 2 s count")


def test_a_statement_is_held_against_its_truth(walk):
    verdicts = walk.to(State.MOVED).do(Trigger.VERIFICATION_PASSED, agree=False).verdicts
    (agree,) = (verdict for verdict in verdicts if verdict.code == "evaluations_agree")
    assert (agree.measured, agree.limit) == (False, True)


def test_where_no_plate_is_needed_none_is_asked_for(walk):
    walk.to(State.IMAGE_ACQUIRED)
    quality = replace(GOOD_QUALITY, plate_required=False, plate_balls=None)
    verdicts = walk.do(Trigger.REGISTRATION_COMPLETED, quality=quality).verdicts
    (plate,) = (verdict for verdict in verdicts if verdict.code == "plate")
    assert (plate.measured, plate.limit) == (None, 0)


def test_the_joint_that_is_out_of_range_is_the_one_that_is_told(walk):
    walk.to(State.TARGET_CHOSEN)
    (verdict,) = walk.refused(Trigger.PLAN_REQUESTED, start_joints_rad=(0.1, -57.3, 0.0, 0.0, 0.0, 0.0)).failed
    assert (verdict.code, verdict.measured) == ("plan_plausible", 57.3)


def test_the_insertion_that_is_in_the_way_is_told(walk):
    walk.to(State.TARGET_CHOSEN)
    answer = spoilt(walk, PROOFS["no_insertion"], PROOFS["no_insertion"].refusing[0])
    told = {verdict.code: verdict.measured for verdict in answer.verdicts}
    assert told["no_insertion"] == "open"
    usual = walk.__class__().to(State.TARGET_CHOSEN).do(Trigger.MOVE_APPROVED)
    assert {verdict.code: verdict.measured for verdict in usual.verdicts}["no_insertion"] == "none"


def test_whose_an_image_is_and_whether_it_is_new_is_judged_alone(walk):
    walk.to(State.CASE_OPEN)
    facts = walk.facts(Trigger.IMAGE_ARRIVED, study_matches=False, pixels_unseen=None)
    verdicts = interlocks.provenance(Inquiry(walk.case, Trigger.IMAGE_ARRIVED, facts, walk.snapshot, LIMITS, 0.0))
    assert {verdict.code: verdict.passed for verdict in verdicts} == {
        "patient_matches": True,
        "study_matches": False,
        "image_unseen": True,
        "pixels_unseen": False,
        "image_newer": True,
    }
