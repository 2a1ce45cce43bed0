"""Overrides: few, by a surgeon, with a reason, up to a hard limit, and for one request; all else never yields."""

import math
from dataclasses import replace

import pytest

from workflow import facts as f
from workflow.case_json import from_json, to_json
from workflow.interlocks import INTERLOCKS
from workflow.limits import Limits
from workflow.machine import allowed
from workflow.overrides import Override
from workflow.refusals import RefusalCode
from workflow.snapshot import Reading
from workflow.states import State
from workflow.triggers import Trigger

LIMITS = Limits()
OLD = Override("image_age", "the C-arm stood all the time", surgeon=True)
AFTER_HALF_AN_HOUR = Reading(True, 2000.0)


@pytest.fixture
def old(new_walk):
    """A chosen target whose image is older than its limit and younger than the hard one."""
    walk = new_walk().to(State.TARGET_CHOSEN)
    walk.spoil(image_exposed=AFTER_HALF_AN_HOUR)
    return walk


def verdict(answer, code="image_age"):
    return next(one for one in answer.verdicts if one.code == code)


def test_only_age_of_the_image_and_what_is_predicted_may_be_overridden():
    assert {code for code, lock in INTERLOCKS.items() if lock.hard} == {"image_age", "aim_angle", "aim_position"}


@pytest.mark.parametrize("trigger", [Trigger.TARGET_CONFIRMED, Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED])
def test_an_override_lets_the_one_request_pass_and_says_so(old, trigger):
    refusal = old.refused(trigger)
    assert verdict(refusal).overridable
    assert verdict(refusal).hard_limit == 3600.0
    decision = old.do(trigger, overrides=(OLD,))
    passed = verdict(decision)
    assert (passed.passed, passed.measured, passed.limit) == (True, 2000.0, 3600.0)
    assert passed.override == OLD.reason
    assert OLD.reason in passed.message
    assert not passed.overridable


def test_each_override_opens_its_own_interlock_alone(old):
    deep = Override("aim_angle", "deep target", surgeon=True)
    assert not verdict(old.refused(Trigger.MOVE_APPROVED, overrides=(deep,))).passed
    assert verdict(old.do(Trigger.MOVE_APPROVED, overrides=(deep, OLD))).override == OLD.reason


def test_the_permit_keeps_its_override_for_its_own_motion_and_for_no_other(old):
    old.do(Trigger.PLAN_REQUESTED, overrides=(OLD,))
    old.do(Trigger.MOVE_APPROVED, overrides=(OLD,))
    old.case = from_json(to_json(old.case))
    old.do(Trigger.MOVE_STARTED)
    old.do(Trigger.RELEASED)
    assert verdict(old.refused(Trigger.PLAN_REQUESTED)).measured == 2000.0


def test_a_plan_s_override_does_not_carry_over_to_its_approval(old):
    old.do(Trigger.PLAN_REQUESTED, overrides=(OLD,))
    assert verdict(old.refused(Trigger.MOVE_APPROVED)).overridable


def test_what_was_overridden_is_refused_again_beyond_the_hard_limit(old):
    old.do(Trigger.MOVE_APPROVED, overrides=(OLD,))
    old.spoil(image_exposed=Reading(True, 3600.0 * (1.0 + 1e-6)))
    started = verdict(old.refused(Trigger.MOVE_STARTED))
    assert started.limit == 3600.0
    assert not started.overridable
    assert verdict(old.refused(Trigger.MOVE_APPROVED, overrides=(OLD,))).limit == 3600.0
    old.spoil(image_exposed=Reading(True, 3600.0))
    old.do(Trigger.MOVE_STARTED)


@pytest.mark.parametrize("age_s", [math.inf, math.nan, -1.0])
def test_an_age_that_is_unknown_is_not_overridden(old, age_s):
    old.spoil(image_exposed=Reading(None, age_s))
    assert not verdict(old.refused(Trigger.MOVE_APPROVED, overrides=(OLD,))).passed


@pytest.mark.parametrize(
    ("override", "code"),
    [
        (replace(OLD, surgeon=False), RefusalCode.ROLE),
        (replace(OLD, reason=""), RefusalCode.REASON_REQUIRED),
        *((Override(code, "why not", surgeon=True), RefusalCode.NOT_OVERRIDABLE) for code in ("lease", "tcp_mm", "x")),
    ],
)
def test_nobody_else_overrides_and_nothing_else_is_overridden(old, override, code):
    assert old.refused(Trigger.MOVE_APPROVED, overrides=(OLD, override)).code is code


@pytest.mark.parametrize(("field", "code"), [("angle_rad", "aim_angle"), ("position_mm", "aim_position")])
def test_what_is_predicted_at_the_target_may_be_overridden_up_to_the_limit_of_the_verification(new_walk, field, code):
    hard = {"aim_angle": LIMITS.angle_error_rad, "aim_position": LIMITS.position_error_mm}[code]
    walk, override = new_walk().to(State.TARGET_CHOSEN), Override(code, "deep target", surgeon=True)
    name = f"predicted_{field}"
    assert verdict(walk.refused(Trigger.PLAN_REQUESTED, **{name: hard}), code).overridable
    beyond = {name: hard * (1.0 + 1e-6)}
    assert verdict(walk.refused(Trigger.PLAN_REQUESTED, **beyond, overrides=(override,)), code).limit == hard
    walk.do(Trigger.PLAN_REQUESTED, **{name: hard}, overrides=(override,))
    assert not verdict(walk.refused(Trigger.MOVE_APPROVED), code).passed
    walk.do(Trigger.MOVE_APPROVED, overrides=(override,))
    walk.do(Trigger.MOVE_STARTED)


def test_the_verification_takes_no_override_at_all():
    kinds = {f.FACTS_OF[trigger] for trigger in Trigger if trigger.startswith(("verification", "insertion"))}
    assert not any(hasattr(kind, "overrides") for kind in kinds)


def test_the_status_says_what_an_override_would_open(old):
    offered = allowed(old.case, old.snapshot, LIMITS, old.now_s)
    reasons = {trigger: [one.overridable for one in offered[trigger].reasons] for trigger in offered}
    assert reasons[Trigger.MOVE_APPROVED] == [True]
    assert reasons[Trigger.MOVE_STARTED] == [False]  # an override comes with the approval


def test_a_permit_of_an_older_record_has_no_overrides(old):
    old.do(Trigger.MOVE_APPROVED, overrides=(OLD,))
    record = to_json(old.case)
    del record["permit"]["overrides"]
    assert from_json(record).permit.overrides == ()
