"""What the guard refuses before a motion, and what it says of an arm that is away or was moved."""

import time
from dataclasses import replace

import numpy as np
import pytest

from robot.guard.messages import (
    BeginMove,
    Disturbed,
    EndCause,
    Fault,
    FaultKind,
    Heartbeat,
    MotionEnded,
    MotionStarted,
    MoveRefused,
    Phase,
    StopSent,
)
from robot.refusal import RefusalCode
from simulator.controller import Fault as Planted
from simulator.controller import Payload, PowerAction

pytestmark = pytest.mark.real_time


def refused(bench, order: BeginMove, code: RefusalCode) -> MoveRefused:
    """Ask for a motion that must be refused without a packet of it."""
    joints_rad = bench.controller.state().joints_rad
    bench.client.begin_move(order)
    answer = bench.told(MoveRefused)
    assert answer.refusal.code is code, answer
    assert bench.count(MotionStarted) == 0
    bench.stays_at_rest()
    assert np.array_equal(joints_rad, bench.controller.state().joints_rad)
    return answer


@pytest.mark.hazard("H13")
def test_motion_without_any_heartbeat_is_refused_without_a_packet(bench) -> None:
    newest = bench.controller.wire()[-1].number
    refused(bench, bench.order(), RefusalCode.NO_LIVE_HEARTBEAT)
    assert bench.controller.wire(newest) == ()


@pytest.mark.hazard("H13")
def test_motion_under_another_permit_than_the_held_one_is_refused(bench) -> None:
    bench.hold("permit-1")
    refused(bench, bench.order("permit-b"), RefusalCode.NO_LIVE_HEARTBEAT)


@pytest.mark.hazard("H13")
def test_motion_under_a_hold_that_was_let_go_is_refused(bench) -> None:
    bench.hold("permit-1")
    bench.client.heartbeat(Heartbeat("permit-1", 10_000, bench.status.challenge, False))
    refused(bench, bench.order(), RefusalCode.NO_LIVE_HEARTBEAT)


@pytest.mark.hazard("H10")
def test_wrong_tcp_is_refused_with_how_far_it_is(bench) -> None:
    tcp = np.eye(4)
    tcp[2, 3] = 0.3
    bench.controller.set_tcp(tcp)
    bench.hold("permit-1")
    bench.until(lambda: bench.count(Disturbed) > 0, 2.0)  # the reported pose jumps with the TCP
    answer = refused(bench, bench.order(), RefusalCode.TCP_MISMATCH)
    assert answer.refusal.measured == pytest.approx(0.3, abs=1e-6)
    assert bench.status.phase is Phase.IDLE


@pytest.mark.hazard("H10")
def test_wrong_payload_is_refused(bench) -> None:
    bench.controller.set_payload(Payload(mass_kg=1.2))
    bench.hold("permit-1")
    bench.until(lambda: bench.status.arm.payload_kg == 1.2, 2.0)
    refused(bench, bench.order(), RefusalCode.PAYLOAD_MISMATCH)


def test_joints_other_than_the_permits_are_refused(bench) -> None:
    bench.hold("permit-1")
    order = bench.order()
    bench.controller.push(np.array([0.0, 0.1, 0.0]))
    disturbed = bench.told(Disturbed)
    assert disturbed.offset_mm == pytest.approx(0.1, abs=0.02)
    refused(bench, order, RefusalCode.ARM_MOVED_SINCE_PERMIT)


def test_motion_faster_than_the_cap_is_refused(bench) -> None:
    bench.hold("permit-1")
    refused(bench, bench.order(speed_mm_s=21.0), RefusalCode.SPEED_ABOVE_CAP)


@pytest.mark.hazard("H18")
def test_guard_that_was_stopped_refuses_until_acknowledged(bench) -> None:
    bench.client.stop("asked")
    bench.told(StopSent)
    bench.hold("permit-1")
    refused(bench, bench.order(), RefusalCode.GUARD_HELD)
    bench.client.acknowledge()
    bench.hold("permit-b")
    bench.client.begin_move(bench.order("permit-b", step_mm=2.0))
    assert bench.told(MotionEnded).cause is EndCause.ARRIVED


def test_second_motion_while_one_runs_is_refused_and_changes_nothing(bench) -> None:
    bench.move()
    bench.client.begin_move(bench.order("permit-b"))
    assert bench.told(MoveRefused).refusal.code is RefusalCode.MOTION_RUNNING
    bench.client.heartbeat(Heartbeat(bench.permit_id, 10_000, bench.status.challenge, False))
    assert bench.told(MotionEnded).cause is EndCause.RELEASED


def test_script_that_never_runs_is_refused(bench) -> None:
    bench.controller.inject(Planted.IGNORES_UPLOADS)
    bench.hold("permit-1")
    refused(bench, bench.order(), RefusalCode.CONTROLLER_REFUSED)


@pytest.mark.hazard("H18")
@pytest.mark.parametrize("planted", [Planted.PROTECTIVE_STOP, Planted.ROBOT_EMERGENCY_STOP])
def test_stop_of_the_arm_without_a_motion_is_a_fault_and_holds_the_guard(bench, planted: Planted) -> None:
    bench.controller.inject(planted)
    assert bench.told(Fault).kind.value in planted.value
    assert bench.status.phase is Phase.HELD
    bench.client.acknowledge()  # a human was too quick
    bench.hold("permit-1")
    refused(bench, bench.order(), RefusalCode.ARM_NOT_READY)


def test_arm_switched_off_and_on_is_a_fault_once_and_then_serves_again(bench) -> None:
    bench.controller.power(PowerAction.OFF)
    assert bench.told(Fault).kind is FaultKind.ARM_OFF
    bench.hold("permit-1")
    bench.client.acknowledge()
    refused(bench, bench.order(), RefusalCode.ARM_NOT_READY)
    bench.controller.release()
    bench.until(lambda: bench.status.arm.safety.value == "normal", 2.0)
    bench.hold("permit-b")
    bench.client.begin_move(bench.order("permit-b", step_mm=2.0))
    assert bench.told(MotionEnded).cause is EndCause.ARRIVED
    assert bench.count(Fault) == 1


def test_lost_feedback_is_a_fault_the_age_grows_and_the_link_comes_back(bench) -> None:
    bench.controller.inject(Planted.RTDE_CLOSED)
    assert bench.told(Fault).kind is FaultKind.FEEDBACK_LOST
    bench.until(lambda: bench.status.sent_at_s - bench.status.arm.received_at_s > 0.5, 3.0)
    assert not bench.status.connected
    bench.hold("permit-1")
    bench.client.acknowledge()
    refused(bench, bench.order(), RefusalCode.ARM_UNREACHABLE)
    bench.controller.clear()
    bench.until(lambda: bench.status.connected, 10.0)
    assert bench.client.status_age_s < 0.5


@pytest.mark.hazard("H04")
def test_jog_from_the_pendant_is_told_as_disturbed(bench) -> None:
    bench.controller.jog_linear(np.array([0.0, 0.0, 1.0]), 5.0)
    bench.told(Disturbed)
    time.sleep(1.0)
    told_mm = sum(event.offset_mm for event in bench.events if isinstance(event, Disturbed))
    assert told_mm == pytest.approx(1.0, abs=0.06)  # mm; what is left is below what is told


def test_motion_of_the_guard_is_not_told_as_disturbed(bench) -> None:
    bench.hold("permit-1")
    bench.client.begin_move(bench.order(step_mm=5.0))
    bench.told(MotionEnded)
    time.sleep(0.3)
    assert bench.count(Disturbed) == 0


def test_goal_here_is_reached(bench) -> None:
    bench.hold("permit-1")
    order = replace(bench.order(), base_from_goal=bench.status.arm.base_from_tcp)
    bench.client.begin_move(order)
    assert bench.told(MotionEnded).cause is EndCause.ARRIVED
