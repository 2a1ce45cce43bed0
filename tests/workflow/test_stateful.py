"""Anything in any order, spoilt or not: the rules keep their promises and never contradict one another."""

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule, run_state_machine_as_test

from workflow.case_json import from_json, to_json
from workflow.decisions import Decision, Effect
from workflow.engine import IllegalTransitionError, fire
from workflow.plans import PlanKind
from workflow.refusals import Refusal
from workflow.rows import Branch
from workflow.snapshot import Reading, SafetySnapshot
from workflow.states import IDLE, LIVE, GuideState, State
from workflow.totality import CELLS
from workflow.triggers import Kind, Trigger

ANSWERS = (Trigger.IMAGE_ARRIVED, Trigger.REGISTRATION_COMPLETED, Trigger.ARRIVED, Trigger.VERIFICATION_PASSED)
READINGS = sorted(SafetySnapshot.__slots__)


def machine_of(new_walk):
    class Procedure(RuleBasedStateMachine):
        def __init__(self) -> None:
            super().__init__()
            self.walk = new_walk()
            self.permits_used: list[str] = []
            self.walk.do(Trigger.GUIDE_STATE_STATED)

        @rule(trigger=st.sampled_from(Trigger), kind=st.sampled_from(PlanKind))
        def anything(self, trigger, kind):
            self.fire(trigger, self.walk.facts(trigger, kind=kind))

        @rule(data=st.data())
        def the_way_onwards(self, data):
            """Apart from `anything`, so that whole procedures happen."""
            answer = self.walk.ask(Trigger.TARGET_DONE)
            if isinstance(answer, Refusal):
                trigger = data.draw(st.sampled_from(answer.leads_onwards))
                self.fire(trigger, self.walk.facts(trigger))

        @rule(trigger=st.sampled_from(ANSWERS))
        def the_room_answers(self, trigger):
            self.fire(trigger, self.walk.facts(trigger))

        @rule(guide=st.sampled_from(GuideState))
        def something_in_the_guide(self, guide):
            self.fire(Trigger.GUIDE_STATE_STATED, self.walk.facts(Trigger.GUIDE_STATE_STATED, guide=guide))

        @rule(name=st.sampled_from(READINGS), age_s=st.sampled_from([9.0, -1.0, float("nan")]))
        @precondition(lambda self: self.walk.case.state in LIVE)
        def stale(self, name, age_s):
            """No motion and no insertion starts on a reading that does not count, if it is asked for."""
            good = self.walk.snapshot
            self.walk.spoil(**{name: Reading(None, age_s)})
            before = self.walk.case
            answer = self.walk.ask(Trigger.MOVE_STARTED)
            used = {"program_running", "motion_locked", "drift_mm", "drift_rad"}
            aimed = before.plan is not None and before.plan.kind in (PlanKind.TARGETING, PlanKind.CORRECTIVE)
            asked_for = name not in used and (aimed or not name.startswith("unaccounted"))
            assert isinstance(answer, Refusal) or not asked_for
            self.walk.case = before
            self.walk.snapshot = good

        @rule(seconds=st.floats(0.0, 60.0))
        def time_passes(self, seconds):
            self.walk.now_s += seconds

        @rule()
        def the_service_restarts(self):
            self.walk.case = from_json(to_json(self.walk.case))
            self.fire(Trigger.RESTARTED, self.walk.facts(Trigger.RESTARTED))

        def fire(self, trigger, facts):
            before, answer = self.walk.case, self.walk.ask(trigger, facts)
            if isinstance(answer, Refusal):
                assert trigger.kind is Kind.REQUEST
                assert trigger is not Trigger.STOP
                assert answer.leads_onwards
                return
            self.check(before, answer)

        def check(self, before, decision: Decision):
            after = decision.after
            if after.state is not before.state:
                assert after.permit is None
            if before.state is State.MOVING and after.state is State.SAFE_HOLD and decision.row != 38:
                assert Effect.STOP_SENT in decision.effects
            if decision.row == 14:
                assert after.used_permit_id not in self.permits_used
                self.permits_used.append(after.used_permit_id)
            if decision.row == 23:
                assert before.verification.passed

        @invariant()
        def a_moving_arm_has_an_empty_guide(self):
            case = self.walk.case
            if case.state is State.MOVING:
                assert case.guide in (GuideState.EMPTY, GuideState.WIRE)
            assert (case.running is not None) == (case.state is State.MOVING)

        @invariant()
        def a_permit_lives_in_calm_states(self):
            assert self.walk.case.permit is None or self.walk.case.state in IDLE

        @invariant()
        def stop_is_always_possible(self):
            case = self.walk.case
            decision = self.walk.do(Trigger.STOP)
            assert decision.effects == (Effect.STOP_SENT,)
            self.walk.case = case

        @invariant()
        def what_is_stored_comes_back(self):
            assert from_json(to_json(self.walk.case)) == self.walk.case

    return Procedure


@pytest.mark.timeout(120)
def test_any_sequence_keeps_the_promises(new_walk):
    # No deadline: the two processor cores are shared with the rest of the tests.
    run_state_machine_as_test(machine_of(new_walk), settings=settings(max_examples=60, stateful_step_count=60))


@pytest.mark.parametrize(("source", "to"), [(State.CLOSED, State.CARM_POSITIONED), (State.REGISTERED, State.VERIFIED)])
def test_the_machine_refuses_a_change_of_state_that_no_row_declares(source, to):
    retake = CELLS[State.REGISTERED, Trigger.RETAKE, Branch.ALWAYS]
    assert fire(State.REGISTERED, retake, State.CARM_POSITIONED) is State.CARM_POSITIONED
    with pytest.raises(IllegalTransitionError):
        fire(source, retake, to)
