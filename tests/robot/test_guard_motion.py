"""The guard as a process over a simulated controller: motions, and everything that ends them."""

import time

import numpy as np
import pytest

from robot.dashboard import stop_by_dashboard
from robot.guard.journal import EVENTS_FILE, read_lines
from robot.guard.messages import EndCause, Heartbeat, MotionEnded, MotionStarted, MoveRefused, Phase, StopSent
from robot.refusal import RefusalCode
from robot.safety import SafetyState
from simulator.controller import Fault

pytestmark = pytest.mark.real_time

STOP_S = 0.05  # from its cause to the wire; a few ms on an idle machine, and the tests run beside others


def test_held_motion_arrives_at_its_goal_and_leaves_no_program(bench) -> None:
    bench.hold("permit-1")
    order = bench.order(step_mm=20.0)
    bench.client.begin_move(order)
    ended = bench.told(MotionEnded)
    assert ended.cause is EndCause.ARRIVED
    assert ended.at_rest
    assert ended.program_stopped
    assert ended.distance_mm < 0.1
    assert bench.status.phase is Phase.IDLE
    assert bench.told(MotionStarted).flange_from_tcp == pytest.approx(np.eye(4), abs=1e-9)
    bench.stays_at_rest()
    state = bench.controller.state()
    reached_mm = (state.base_from_flange_nominal @ state.flange_from_tcp)[:3, 3]
    assert reached_mm == pytest.approx(order.base_from_goal[:3, 3], abs=0.1)


def test_trajectory_and_events_are_in_the_journal(bench) -> None:
    bench.hold("permit-1")
    bench.client.begin_move(bench.order(step_mm=10.0))
    ended = bench.told(MotionEnded)
    events = [line["type"] for line in read_lines(bench.journal_folder / EVENTS_FILE)]
    assert events == ["acknowledge", "begin_move", "motion_started", "motion_ended"]
    samples = read_lines(bench.journal_folder / ended.trajectory_file)
    assert len(samples) == ended.trajectory_samples
    times = np.array([sample["controller_time_s"] for sample in samples])
    assert np.median(np.diff(times)) == pytest.approx(0.008, abs=1e-6)  # 125 Hz
    assert samples[-1]["base_from_tcp"][2][3] - samples[0]["base_from_tcp"][2][3] == pytest.approx(10.0, abs=0.2)


def test_second_motion_starts_right_after_the_first(bench) -> None:
    bench.hold("permit-1")
    bench.client.begin_move(bench.order(step_mm=3.0))
    assert bench.told(MotionEnded).cause is EndCause.ARRIVED
    bench.hold("permit-b")
    bench.client.begin_move(bench.order("permit-b", step_mm=-3.0, duration_s=1.0))
    bench.until(lambda: bench.count(MotionEnded) == 2, 8.0)
    assert bench.told(MotionEnded).cause is EndCause.ARRIVED


def test_release_stops_the_arm_and_leaves_the_guard_idle(bench) -> None:
    bench.move()
    at_s = time.monotonic()
    bench.client.heartbeat(Heartbeat(bench.permit_id, 10_000, bench.status.challenge, False))
    ended = bench.told(MotionEnded)
    assert ended.cause is EndCause.RELEASED
    assert ended.at_rest
    assert bench.first_stop_after(at_s) < STOP_S
    assert bench.status.phase is Phase.IDLE
    bench.stays_at_rest()


@pytest.mark.hazard("H16")
def test_silence_stops_the_arm_after_two_hundred_milliseconds_and_holds_the_guard(bench) -> None:
    bench.move()
    bench.silent = True
    ended = bench.told(MotionEnded)
    assert ended.cause is EndCause.HEARTBEAT_LOST
    assert 0.2 <= ended.stop_sent_at_s - bench.last_challenge_at_s < 0.2 + STOP_S
    assert bench.first_stop_after(bench.last_challenge_at_s) >= 0.2
    bench.silent = False  # the link comes back with the button still held
    bench.stays_at_rest()
    assert bench.status.phase is Phase.HELD


@pytest.mark.hazard("H36")
def test_heartbeats_that_come_a_second_late_are_silence(bench) -> None:
    bench.move()
    bench.delay_s = 1.0
    ended = bench.told(MotionEnded)
    assert ended.cause is EndCause.HEARTBEAT_LOST
    assert ended.distance_mm > 20.0  # mm: it was far from its goal of 40
    bench.stays_at_rest()


def test_stop_goes_out_at_once_and_is_told(bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robot.guard.client.stop_by_dashboard", lambda address: True)  # the guard's own stop is meant
    bench.move()
    at_s = time.monotonic()
    assert bench.client.stop("a nurse asked")
    ended = bench.told(MotionEnded)
    assert bench.first_stop_after(at_s) < STOP_S
    assert bench.told(StopSent).written
    assert (ended.cause, ended.at_rest, ended.program_stopped) == (EndCause.STOPPED, True, True)
    assert bench.status.phase is Phase.HELD
    bench.stays_at_rest()


def test_stop_needs_no_guard(bench) -> None:
    bench.move()
    send = bench.client._child.send
    bench.client._child.send = lambda line: b'"stop"' not in line and send(line)  # heartbeats go on
    at_s = time.monotonic()
    assert not bench.client.stop("a nurse asked")
    assert bench.told(MotionEnded).cause is EndCause.CONTROL_LOST
    assert bench.first_stop_after(at_s) < STOP_S
    bench.stays_at_rest()


def test_line_that_nobody_understands_stops_the_arm(bench) -> None:
    bench.move()
    bench.client._child.send(b'{"type":"stp"}\n')
    assert bench.told(MotionEnded).cause is EndCause.STOPPED


_STOPS = {
    Fault.PROTECTIVE_STOP: EndCause.PROTECTIVE_STOP,
    Fault.SAFEGUARD_STOP: EndCause.SAFEGUARD_STOP,
    Fault.ROBOT_EMERGENCY_STOP: EndCause.EMERGENCY_STOP,
    Fault.SYSTEM_EMERGENCY_STOP: EndCause.EMERGENCY_STOP,
    Fault.SAFETY_FAULT: EndCause.SAFETY_FAULT,
}


@pytest.mark.hazard("H18")
def test_safety_stop_ends_the_motion_for_good(bench) -> None:
    for fault, cause in _STOPS.items():
        bench.move()
        bench.controller.inject(fault)
        assert bench.told(MotionEnded).cause is cause
        assert bench.status.phase is Phase.HELD
        bench.controller.release()  # a person unlocks it at the pendant, with the button still held
        bench.stays_at_rest()
        bench.until(lambda: bench.status.arm.safety is SafetyState.NORMAL, 5.0)
        bench.client.acknowledge()
        bench.until(lambda: bench.status.phase is Phase.IDLE, 5.0)
        bench.events.clear()


@pytest.mark.hazard("H21")
@pytest.mark.parametrize("fault", [Fault.VALUES_FREEZE, Fault.TIMESTAMP_STOPS, Fault.VALUES_NAN, Fault.PACKETS_STOP])
def test_feedback_that_lies_or_fails_ends_the_motion(bench, fault: Fault) -> None:
    bench.move()
    at_s = time.monotonic()
    bench.controller.inject(fault)
    ended = bench.told(MotionEnded)
    assert ended.cause is EndCause.FEEDBACK_LOST
    assert bench.first_stop_after(at_s) < 0.1 + STOP_S + 0.02  # stale after 0.1 s, and the fault takes a moment
    bench.controller.clear()
    bench.stays_at_rest()
    bench.until(bench.sees_the_arm, 15.0)
    assert bench.status.phase is Phase.HELD


def test_guard_whose_library_hangs_on_frozen_answers_is_replaced_and_serves_again(bench) -> None:
    bench.move()
    guard = bench.client.process_id
    bench.controller.inject(Fault.VALUES_FREEZE)
    bench.told(MotionEnded)
    bench.until(lambda: bench.client.process_id not in (guard, None), 10.0)
    bench.controller.clear()
    bench.until(bench.sees_the_arm, 15.0)
    bench.client.acknowledge()
    bench.hold("permit-b")
    bench.client.begin_move(bench.order("permit-b", step_mm=2.0))
    bench.until(lambda: bench.count(MotionEnded) == 2, 8.0)
    assert bench.told(MotionEnded).cause is EndCause.ARRIVED


def test_closed_connection_ends_the_motion_though_the_library_may_take_the_guard_with_it(bench) -> None:
    bench.move()
    at_s = time.monotonic()
    bench.controller.inject(Fault.RTDE_CLOSED)
    bench.until(lambda: not bench.controller.state().moving, 2.0)
    assert bench.first_stop_after(at_s) < 0.3
    bench.controller.clear()
    bench.stays_at_rest()
    bench.until(bench.sees_the_arm, 20.0)
    assert bench.status.phase is Phase.HELD


def test_lost_dashboard_leaves_the_stop_by_register(bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robot.guard.client.stop_by_dashboard", lambda address: False)
    bench.move()
    bench.controller.inject(Fault.DASHBOARD_CLOSED)
    at_s = time.monotonic()
    bench.client.stop("asked")
    ended = bench.told(MotionEnded)
    assert ended.at_rest
    assert bench.first_stop_after(at_s) < 0.1
    bench.stays_at_rest()


def test_arm_that_comes_to_rest_elsewhere_has_missed(bench) -> None:
    bench.controller.inject(Fault.FALLS_SHORT)
    bench.hold("permit-1")
    bench.client.begin_move(bench.order(step_mm=20.0))
    ended = bench.told(MotionEnded)
    assert ended.cause is EndCause.MISSED
    assert ended.distance_mm > 0.1
    assert bench.status.phase is Phase.IDLE


def test_program_stopped_at_the_pendant_is_lost_control(bench) -> None:
    bench.move()
    assert stop_by_dashboard(bench.controller.address)
    assert bench.told(MotionEnded).cause is EndCause.CONTROL_LOST
    bench.stays_at_rest()


@pytest.mark.hazard("H14")
def test_permit_moves_the_arm_once(bench) -> None:
    bench.hold("permit-1")
    order = bench.order(step_mm=3.0)
    bench.client.begin_move(order)
    bench.told(MotionEnded)
    bench.client.begin_move(bench.order(step_mm=3.0))
    assert bench.told(MoveRefused).refusal.code is RefusalCode.PERMIT_REUSED
    bench.stays_at_rest()
