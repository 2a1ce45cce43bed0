"""What the service believes of the arm's place: unknown where the guard saw nothing (H04)."""

from itertools import count

import numpy as np
import pytest

from robot.arm import ArmState
from robot.guard.messages import EndCause, Fault, FaultKind, MotionEnded, MotionStarted, Phase, Status
from robot.safety import SafetyState
from service.motion.arm_watch import ArmWatch


class Told(ArmWatch):
    """A watch that is told of an arm at places along base x."""

    def __init__(self) -> None:
        super().__init__(lambda: 0.0)
        self._numbers = count(1)

    def seen(self, x_mm: float, phase: Phase = Phase.IDLE) -> None:
        number = next(self._numbers)
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
    return ArmState(time_s, time_s, still, still, pose, 0.0, 0.0, 1.0, np.zeros(3), *words)


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
