"""What the service believes of the arm's place: unknown where the guard saw nothing (H04)."""

from dataclasses import replace
from itertools import count

import numpy as np
import pytest

from robot.arm import ArmState
from robot.guard.messages import EndCause, Fault, FaultKind, MotionEnded, MotionStarted, Phase, Status
from robot.safety import SafetyState
from service.conductor.configuration import Configuration
from service.conductor.limits import limits_from
from service.conductor.snapshots import Held, measure
from service.conductor.status import allowances
from service.conductor.taking import Rules
from service.motion.arm_watch import ArmWatch
from service.settings import ProcedureLimits
from workflow.case import Motion, Plan, Verification, opened
from workflow.links import Artefact
from workflow.plans import PlanKind
from workflow.states import GuideState, State
from workflow.triggers import Trigger

_CONFIGURATION = Configuration("now", "now")
_LIMITS = limits_from(ProcedureLimits(image_age_s=60.0))


class Told(ArmWatch):
    """A watch that is told of an arm at places along base x."""

    def __init__(self) -> None:
        super().__init__(lambda: self.now_s, lambda: self.now_s + self.asleep_s)
        self.now_s = self.asleep_s = 0.0
        self._numbers = count(1)

    def seen(self, x_mm: float, phase: Phase = Phase.IDLE) -> None:
        number = next(self._numbers)
        self.now_s = 0.01 * number
        self.take(Status(number, 0.01 * number, phase, "", True, arm_at(x_mm, 0.01 * number), None, False, None))

    def started(self, x_mm: float) -> None:
        arm = arm_at(x_mm, 0.0)
        self.take(MotionStarted("p", 0.0, arm.base_from_tcp, arm.joints_rad, np.eye(4), 1.0, np.zeros(3)))
        self.seen(x_mm, Phase.MOVING)

    def ended(self, x_mm: float) -> None:
        arm = arm_at(x_mm, 0.0)
        self.take(MotionEnded("p", EndCause.ARRIVED, 0.0, True, True, 0.0, 0.0, arm, None, "", 0))
        self.seen(x_mm)

    def exposed(self, image: str) -> None:
        self.open_exposure(f"window of {image}")
        self.assign_exposure(f"window of {image}", image)


def arm_at(x_mm: float, time_s: float) -> ArmState:
    pose = np.eye(4)
    pose[0, 3] = x_mm
    still = np.zeros(6)
    words = (1, 1, 7, 1, False, SafetyState.NORMAL)
    return ArmState(time_s, time_s, still, still, pose, 0.0, 0.0, np.zeros(3), 1.0, np.zeros(3), *words)


@pytest.fixture
def watch() -> Told:
    watch = Told()
    watch.seen(0.0)
    watch.exposed("image")
    return watch


def test_a_commanded_motion_is_accounted_for_and_a_push_beside_it_is_not(watch):
    watch.started(0.0)
    watch.ended(30.0)
    assert watch.unaccounted("image").offset_mm == pytest.approx(0.0)
    watch.seen(30.2)
    assert watch.unaccounted("image").offset_mm == pytest.approx(0.2)


@pytest.mark.hazard("H04")
def test_a_guard_that_dies_amid_a_motion_leaves_the_displacement_unknown_until_the_next_exposure(watch):
    watch.started(0.0)
    watch.take(Fault(FaultKind.GUARD_LOST, 0.0, "the guard died"))
    watch.seen(12.0)
    assert watch.unaccounted("image") is None
    watch.exposed("next")
    watch.seen(17.0)
    assert watch.unaccounted("image") is None
    assert watch.unaccounted("next").offset_mm == pytest.approx(5.0)


def test_a_guard_that_dies_at_rest_leaves_the_displacement_measurable(watch):
    watch.take(Fault(FaultKind.GUARD_LOST, 0.0, "the guard died"))
    watch.seen(0.1)
    assert watch.unaccounted("image").offset_mm == pytest.approx(0.1)


@pytest.mark.hazard("H18")
@pytest.mark.parametrize("phase", list(Phase))
def test_an_arm_that_stands_is_at_rest_once_the_guard_has_ended_its_motion(watch, phase):
    watch.seen(0.0, phase)
    assert watch.reading().at_rest is (phase not in (Phase.MOVING, Phase.STOPPING))


def test_an_exposure_is_watched_on_beside_a_newer_request_that_may_be_refused(watch):
    watch.open_exposure("first")
    watch.open_exposure("second")
    watch.seen(0.5)
    watch.seen(0.0)
    assert watch.exposure_of_window("first").largest.offset_mm == pytest.approx(0.5)


def test_an_exposure_behind_many_requests_is_unknown_and_not_still(watch):
    for number in range(20):
        watch.open_exposure(f"window {number}")
    assert watch.exposure_of_window("window 0") is None
    assert watch.exposure_of_window("window 19") is not None


@pytest.mark.hazard("H21")
def test_a_reading_that_is_told_again_beside_an_event_is_no_clock_that_stands_still(watch):
    watch.seen(0.0)
    arm = watch.reading().arm
    for connected in (True, False):  # the guard says itself when nothing new comes
        watch.take(Status(99, watch.now_s, Phase.IDLE, "", connected, arm, None, False, None))
        assert watch.reading().advances is connected


def _offered(watch: Told, trigger: Trigger, **changes: object) -> set[str]:
    """What the status holds against a trigger in a case whose image is `image`; empty where it is offered."""
    image, motion = Artefact("image", ("view",)), Motion("motion", ("plan", "permit"), PlanKind.TARGETING)
    chain = {"view": Artefact("view", ()), "image": image, "registration": Artefact("registration", ("image",))}
    case = replace(opened("case"), guide=GuideState.EMPTY, **(chain | changes), motion=motion)
    snapshot = measure(watch, case, Trigger.READ, Held(None, None, _CONFIGURATION))
    answer = allowances(case, snapshot, Rules(watch, _LIMITS, lambda: 0.0, "settings", "room-1"))[trigger]
    return set() if answer.allowed else {answer.code, *(verdict.code for verdict in answer.reasons)}


def test_an_image_older_than_the_site_allows_offers_no_target(watch):
    registered = {"state": State.REGISTERED}
    watch.now_s = 60.0
    assert _offered(watch, Trigger.TARGET_CONFIRMED, **registered) == set()
    watch.now_s = 60.1
    assert _offered(watch, Trigger.TARGET_CONFIRMED, **registered) == {"interlock", "image_age"}


@pytest.mark.hazard("H23")
def test_an_image_ages_while_the_machine_sleeps(watch):
    watch.asleep_s = 60.1
    assert _offered(watch, Trigger.TARGET_CONFIRMED, state=State.REGISTERED) == {"interlock", "image_age"}


def test_the_status_offers_the_newest_image_again_by_its_own_exposure(watch):
    again = {"state": State.CARM_POSITIONED, "image": None, "registration": None, "newest_image_id": "newest"}
    watch.seen(0.2)
    watch.exposed("newest")
    assert _offered(watch, Trigger.NEWEST_IMAGE_REUSED, **again) == set()
    watch.seen(0.4)
    assert _offered(watch, Trigger.NEWEST_IMAGE_REUSED, **again) == {"interlock", "unaccounted_mm"}


def test_the_status_judges_a_correction_by_the_exposure_of_the_verification(watch):
    judged = Verification("evaluation", ("verifying", "motion"), "verifying", "motion", passed=False, judged_s=0.0)
    target, plan = Artefact("target", ("image", "registration")), Plan("plan", (), PlanKind.TARGETING, False, (), True)
    off = {"state": State.OFF_TARGET, "target": target, "plan": plan, "verification": judged}
    watch.exposed("verifying")
    watch.seen(0.2)
    assert "unaccounted_mm" in _offered(watch, Trigger.CORRECTION_REQUESTED, **off)
    watch.exposed("verifying")
    assert _offered(watch, Trigger.CORRECTION_REQUESTED, **off) == set()
