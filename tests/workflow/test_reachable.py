"""Every configuration that a case can reach, searched breadth first, with what must hold on every step."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace

import pytest

from workflow import facts as f
from workflow.case import CaseState, opened
from workflow.decisions import Decision, Effect
from workflow.limits import Limits
from workflow.machine import decide
from workflow.plans import PlanKind
from workflow.rows import Goto, Row
from workflow.states import IDLE, LIVE, OVER, GuideState, State
from workflow.table import TABLE
from workflow.triggers import Trigger

# Measured once; a smaller search would prove less.
LEAST_CONFIGURATIONS = 1000
LEAST_STEPS = 20_000


@dataclass(frozen=True)
class Step:
    before: CaseState
    trigger: Trigger
    facts: f.Facts
    after: CaseState
    decision: Decision


def variants(case: CaseState, trigger: Trigger, good: f.Facts) -> Iterator[f.Facts]:
    """The ways in which a trigger can come that make a difference to the table."""
    yield good
    match good:
        case f.MotionEnded():
            yield replace(good, distance_mm=5.0)
            yield replace(good, at_rest=None)
        case f.GuideStated():
            yield f.GuideStated(GuideState.WIRE)
            yield f.GuideStated(GuideState.INSTRUMENT)
        case f.ImageArrived():
            yield replace(good, patient_matches=False)
        case f.RegistrationCompleted():
            yield replace(good, quality=replace(good.quality, handedness_proved=False))
        case f.Evaluated():
            yield replace(good, agree=False)
            yield replace(good, motion_chi_square=18.6)
            yield replace(good, anatomy_across_mm=0.6)
            yield replace(good, anatomy_along_mm=None)
        case f.TargetDone():
            yield f.TargetDone(placed=False, reason="abandoned")


def plain(case: CaseState) -> CaseState:
    """Two cases that differ only in counters, in which permit was used last or in the cause of a hold are one."""
    return replace(case, images=0, corrections=0, used_permit_id=None, held_for=None, control_token=None)


def steps_from(case: CaseState, facts_of, snapshot) -> Iterator[Step]:
    for trigger in Trigger:
        kinds = PlanKind if trigger is Trigger.PLAN_REQUESTED else (PlanKind.TARGETING,)
        for kind in kinds:
            for facts in variants(case, trigger, facts_of(case, trigger, str, kind)):
                answer = decide(case, trigger, facts, snapshot, Limits(motion_chi_square=18.5), 0.0)
                if isinstance(answer, Decision):
                    yield Step(case, trigger, facts, plain(answer.after), answer)


@pytest.fixture(scope="module")
def steps(request) -> list[Step]:
    facts_of, snapshot = request.getfixturevalue("facts_of"), request.getfixturevalue("snapshot_of")()
    start = plain(opened("case"))
    seen, queue, found = {start}, deque([start]), []
    while queue:
        for step in steps_from(queue.popleft(), facts_of, snapshot):
            found.append(step)
            if step.after not in seen:
                seen.add(step.after)
                queue.append(step.after)
    return found


@pytest.fixture(scope="module")
def configurations(steps) -> set[CaseState]:
    return {step.after for step in steps}


def test_the_search_is_exhaustive_enough_to_mean_something(steps, configurations, capsys):
    with capsys.disabled():
        print(f"\n{len(configurations)} configurations, {len(steps)} steps")
    assert len(configurations) >= LEAST_CONFIGURATIONS
    assert len(steps) >= LEAST_STEPS
    assert {case.state for case in configurations} == set(State)


@pytest.mark.hazard("H35")
def test_the_arm_moves_only_with_an_empty_guide_or_along_a_wire(steps):
    starts = [step for step in steps if step.trigger is Trigger.MOVE_STARTED]
    assert starts
    for step in starts:
        plan = step.before.plan
        along_wire = step.before.guide is GuideState.WIRE and plan.kind is PlanKind.RETREAT and plan.axial
        assert step.before.guide is GuideState.EMPTY or along_wire
        assert step.before.insertion is None
    assert {step.before.guide for step in starts} == {GuideState.EMPTY, GuideState.WIRE}


def test_the_arm_moves_only_by_a_started_motion(steps):
    for step in steps:
        if step.after.state is State.MOVING and step.before.state is not State.MOVING:
            assert step.trigger is Trigger.MOVE_STARTED
            assert step.before.permit is not None
        assert (step.after.running is not None) == (step.after.state is State.MOVING)


@pytest.mark.hazard("H35")
def test_no_instrument_is_in_the_guide_of_a_moving_arm(configurations):
    for case in configurations:
        if case.state is State.MOVING:
            assert case.guide in (GuideState.EMPTY, GuideState.WIRE)
            assert case.insertion is None


@pytest.mark.hazard("H28")
def test_an_insertion_starts_only_on_a_passed_verification_newer_than_the_motion(steps):
    starts = [step for step in steps if step.trigger is Trigger.INSERTION_STARTED]
    assert starts
    for step in starts:
        verification, motion = step.before.verification, step.before.motion
        assert verification.passed
        assert motion is None or verification.motion_id == motion.id


@pytest.mark.hazard("H22")
def test_a_motion_voids_every_verification_before_it(configurations):
    for case in configurations:
        if case.state is State.MOVING:
            assert case.verification is None
            assert case.motion is None


def test_no_permit_outlives_its_state(steps):
    for step in steps:
        if step.after.state is not step.before.state:
            assert step.after.permit is None
            assert step.after.window is None
        if step.after.permit is not None:
            assert step.after.state in IDLE


def test_a_restart_leaves_no_verification_and_keeps_insertion_and_guide(steps):
    for step in (step for step in steps if step.trigger is Trigger.RESTARTED and step.before.state in LIVE):
        after = step.after
        assert after.state is State.SAFE_HOLD
        assert (after.view, after.plan, after.permit, after.motion, after.verification) == (None,) * 5
        assert (after.insertion, after.guide) == (step.before.insertion, step.before.guide)


def test_stop_is_possible_everywhere_and_always_sent(steps, configurations):
    stops = {step.before: step for step in steps if step.trigger is Trigger.STOP}
    assert configurations <= stops.keys()
    for step in stops.values():
        assert step.decision.effects == (Effect.STOP_SENT,)
        assert step.after.state is (step.before.state if step.before.state in OVER else State.SAFE_HOLD)


def test_observations_and_facts_are_taken_everywhere(steps, configurations):
    taken = {(step.before, step.trigger) for step in steps}
    for trigger in (trigger for trigger in Trigger if trigger.kind.value != "q"):
        assert all((case, trigger) in taken for case in configurations)


def test_every_live_configuration_can_be_closed(steps, configurations):
    before: dict[CaseState, set[CaseState]] = {}
    for step in steps:
        before.setdefault(step.after, set()).add(step.before)
    closing = {case for case in configurations if case.state is State.CLOSED}
    queue = deque(closing)
    while queue:
        for case in before.get(queue.popleft(), set()) - closing:
            closing.add(case)
            queue.append(case)
    stuck = {case for case in configurations if case.state in LIVE} - closing
    assert not stuck, next(iter(stuck))


@pytest.mark.hazard("H22")
def test_every_link_has_what_it_was_made_from(configurations):
    """H22: nothing stands on something void, save what a later motion or a turned C-arm may leave."""
    for case in configurations:
        assert case.image is None or case.view is not None
        assert case.registration is None or case.image is not None
        assert case.target is None or case.registration is not None
        assert case.permit is None or case.plan is not None
        assert case.verification is None or case.verification.passed or case.motion is not None


@pytest.mark.hazard("H22")
def test_what_moved_leaves_nothing_to_aim_with(steps):
    gone = {
        Trigger.CARM_MOVED: ("view", "image", "registration", "target", "plan", "permit", "motion"),
        Trigger.PATIENT_MOVED: ("image", "registration", "target", "plan", "permit", "motion", "verification"),
        Trigger.ARM_DISTURBED: ("image", "registration", "target", "plan", "permit", "motion", "verification"),
        Trigger.HAND_GUIDED: ("image", "registration", "target", "plan", "permit", "motion", "verification"),
        Trigger.DEVICE_CHANGED: ("view", "image", "registration", "target", "plan", "permit", "motion", "verification"),
    }
    for step in (step for step in steps if step.trigger in gone and step.before.state in LIVE):
        assert all(getattr(step.after, link) is None for link in gone[step.trigger])
        assert step.after.newest_image_id is None


def test_the_declared_ends_of_settling_rows_are_exactly_those_reached(steps):
    reached: dict[int, set[State]] = {}
    rows = [entry for entry in TABLE if isinstance(entry, Row) and entry.to is Goto.SETTLE]
    for step in steps:
        for at, row in enumerate(rows):
            same_row = row.number == step.decision.row and row.trigger is step.trigger
            if same_row and step.before.state in row.sources:
                reached.setdefault(at, set()).add(step.after.state)
    for at, row in enumerate(rows):
        assert row.settles_to == reached[at], f"row {row.number} on {row.trigger}"
