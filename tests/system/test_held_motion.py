"""A held motion through service and guard to a controller, and every way that it ends."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median

import numpy as np
import pytest

from coaxial_client import Refused
from simulator.controller import Fault, Payload
from tests.system.service_process import PIN
from tests.system.walk import lifting, tilted_guide


def _joints(controller) -> np.ndarray:
    return np.array(controller.state().joints_rad)


@pytest.fixture
def held(case, controller):
    """A motion under way: 60 mm, three seconds."""
    with lifting(case, controller, 60.0) as hold:
        yield hold


def _comes_to_rest(controller, until) -> None:
    """Within the time of a stop, with no program left that could go on."""
    until(lambda: not controller.state().moving, 2.0)
    before = _joints(controller)
    time.sleep(0.5)
    assert np.array_equal(before, _joints(controller))
    assert controller.state().program == ""


def test_an_approved_and_held_approach_arrives_and_is_recorded_with_its_trajectory(case, lift) -> None:
    plan = lift(20.0)
    assert plan["detail"]["length_mm"] == pytest.approx(20.0, abs=0.01)
    with case.hold(case.approve(plan, PIN)) as hold:
        ended = hold.wait(30.0)
    assert ended.cause == "arrived"
    assert ended.distance_mm < 0.1  # the guard's own limit of an arrival
    assert case.status()["state"] == "case_open"
    missed = next(event for event in case.record() if event["trigger"] in ("arrived", "missed"))
    assert missed["data"]["trajectory_samples"] > 100


def test_letting_go_stops_the_arm_and_needs_no_acknowledgement(case, held, controller, until) -> None:
    held.release()
    assert held.wait(5.0).cause == "released"
    _comes_to_rest(controller, until)
    assert case.status()["state"] == "case_open"


@pytest.mark.hazard("H16")
def test_silence_stops_the_arm_and_holds_the_case(case, held, controller, until) -> None:
    held.fall_silent()
    assert held.wait(5.0).cause == "heartbeat_lost"
    _comes_to_rest(controller, until)
    status = case.status()
    assert (status["state"], status["held_for"]) == ("safe_hold", "heartbeat_lost")


@pytest.mark.hazard("H20")
def test_a_frozen_service_is_silence_and_its_return_moves_nothing(case, held, service, controller, until) -> None:
    service.process.send_signal(signal.SIGSTOP)
    _comes_to_rest(controller, until)
    service.process.send_signal(signal.SIGCONT)
    _comes_to_rest(controller, until)
    assert case.wait_for("safe_hold")["held_for"] == "heartbeat_lost"


@pytest.mark.hazard("H17")
def test_a_killed_guard_is_replaced_and_the_next_plan_starts_where_the_arm_is(
    case, held, service, controller, until, lift
) -> None:
    os.kill(_guard_of(service), signal.SIGKILL)
    _comes_to_rest(controller, until)
    ended = held.wait(10.0)
    assert (ended.cause, ended.state) == ("guard_lost", "safe_hold")
    assert case.wait_for("safe_hold")["held_for"] == "guard_lost"
    until(lambda: case.status()["arm"]["connected"] and case.status()["arm"]["phase"] == "held")
    with pytest.raises(Refused):
        lift(10.0)
    case.command("acknowledged", guide="empty")
    before = _joints(controller)
    with case.hold(case.approve(lift(5.0), PIN)) as hold:
        assert hold.wait(20.0).cause == "arrived"
    assert np.abs(_joints(controller) - before).max() < 0.1  # rad: 5 mm from there, not what was left of the old way


def _guard_of(service) -> int:
    """The service's child that guards."""
    for child in Path(f"/proc/{service.process.pid}/task").glob("*/children"):
        for process_id in child.read_text().split():
            if b"robot.guard" in Path(f"/proc/{process_id}/cmdline").read_bytes():
                return int(process_id)
    raise AssertionError("the service has no guard")


def test_a_stop_ends_the_motion_for_good(case, held, controller, until) -> None:
    case.stop()
    assert held.wait(5.0).cause == "stopped"
    _comes_to_rest(controller, until)
    assert case.status()["held_for"] == "stop"
    case.command("acknowledged", guide="empty")
    _comes_to_rest(controller, until)
    assert case.status()["chain"]["permit"] is None


def test_emergency_access_leaves_the_arm_to_the_pendant_and_holds_the_case(case, held, controller, until) -> None:
    answer = case.emergency_access()
    assert answer["sent_to_guard"]
    assert answer["recorded"]
    assert answer["pendant_released"]
    assert held.wait(5.0).cause == "stopped"
    _comes_to_rest(controller, until)
    assert case.status()["state"] == "safe_hold"
    stop = next(event for event in reversed(case.record()) if event["trigger"] == "stop")
    assert stop["data"]["emergency_access"]
    newest = controller.wire()[-1].number
    controller.jog_linear(np.array([0.0, 0.0, 5.0]))  # by hand
    time.sleep(1.0)
    assert controller.wire(newest) == ()
    assert "arm_disturbed" in {event["trigger"] for event in case.record()}


def test_emergency_access_is_open_to_every_role_with_a_locked_session_too(case, service) -> None:
    with service.sign_in("operator") as operator:
        operator.post("/session/lock")
        assert operator.case(case.id).emergency_access()["recorded"]
    assert case.status()["state"] == "safe_hold"


@contextmanager
def _every_core_busy() -> Iterator[None]:
    burning = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() or 1)]
    try:
        yield
    finally:
        for process in burning:
            process.kill()
            process.wait()


def _stop_s(case, controller, until) -> float:
    """From the request to the wire; each stop is sent twice, by the guard and beside it."""
    newest, at_s = controller.wire()[-1].number, time.monotonic()
    assert case.stop()["sent_to_guard"]
    until(lambda: sum(record.text == "stop" for record in controller.wire(newest)) >= 2)
    return next(record.at_s for record in controller.wire(newest) if record.text == "stop") - at_s


@pytest.mark.hazard("H32")
def test_a_stop_waits_for_no_image_and_for_no_core(case, carm, controller, until) -> None:
    case.command("carm-position-confirmed")
    case.command("exposure-requested")
    carm.expose(tilted_guide())
    with _every_core_busy():
        took_s = [_stop_s(case, controller, until) for _ in range(5)]
    assert "registration_completed" not in {event["trigger"] for event in case.record()}  # it was at work all the while
    assert median(took_s) < 0.05


@pytest.mark.parametrize(
    ("plant", "kind", "cause"),
    [
        (lambda controller: controller.inject(Fault.FORCE_STEP), "force_rise", "force_rise"),
        (lambda controller: controller.set_payload(Payload(1.3)), "installation_changed", "payload_changed"),
        (lambda controller: controller.inject(Fault.RTDE_RESET), "feedback_lost", "feedback_lost"),
    ],
)
def test_a_fault_amid_a_motion_is_a_typed_event_and_holds_the_case(
    case, held, controller, until, plant, kind, cause
) -> None:
    plant(controller)
    assert held.wait(5.0).cause == cause
    _comes_to_rest(controller, until)
    assert case.wait_for("safe_hold")["held_for"] in (kind, "guard_lost")  # a guard whose link broke ends itself
    fault = next(event for event in case.record() if event["trigger"] == "fault")
    assert fault["data"]["cause"] == cause
    assert case.status()["chain"]["permit"] is None
    controller.set_payload(Payload())
    controller.release()
    until(lambda: case.status()["arm"]["connected"], 20.0)


@pytest.mark.hazard("H15")
def test_taking_control_from_a_moving_arm_stops_it_first(case, held, service, controller, until) -> None:
    with service.sign_in() as second:
        second.case(case.id).take_lease("taking over")
    assert held.wait(5.0).cause == "stopped"
    _comes_to_rest(controller, until)
    assert case.status()["state"] == "safe_hold"


@pytest.mark.hazard("H35")
def test_an_instrument_stated_during_a_motion_stops_it(case, held, controller, until) -> None:
    case.command("guide-state-stated", guide="instrument")
    _comes_to_rest(controller, until)
    assert case.status()["state"] == "safe_hold"


@pytest.mark.hazard("H18")
@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        (Fault.PROTECTIVE_STOP, "protective_stop"),
        (Fault.SAFEGUARD_STOP, "safeguard_stop"),
        (Fault.ROBOT_EMERGENCY_STOP, "emergency_stop"),
    ],
)
def test_a_stop_of_the_controller_is_latched_until_it_is_released_and_acknowledged(
    case, held, controller, until, fault, cause
) -> None:
    controller.inject(fault)
    assert held.wait(5.0).cause == cause
    assert case.wait_for("safe_hold")["held_for"] == cause
    with pytest.raises(Refused) as caught:
        case.command("acknowledged", guide="empty")
    assert "safety_normal" in {verdict["code"] for verdict in caught.value.verdicts if not verdict["passed"]}
    controller.release()
    until(lambda: case.status()["arm"]["safety"] == "normal")
    _comes_to_rest(controller, until)
    assert case.command("acknowledged", guide="empty")["state"] == "case_open"


@pytest.mark.hazard("H14")
def test_a_permit_is_good_for_one_motion(case, lift, controller) -> None:
    permit = case.approve(lift(10.0), PIN)
    with case.hold(permit) as hold:
        hold.wait(20.0)
    before = len([one for one in controller.wire() if one.kind == "script"])
    with pytest.raises(Refused) as caught, case.hold(permit):
        pass
    assert "permit_unused" in {verdict["code"] for verdict in caught.value.verdicts if not verdict["passed"]}
    assert len([one for one in controller.wire() if one.kind == "script"]) == before


@pytest.mark.hazard("H13")
def test_a_button_that_nobody_holds_starts_nothing(case, lift, controller) -> None:
    hold = case.hold(case.approve(lift(10.0), PIN))
    hold.release()
    before = _joints(controller)
    with hold:
        time.sleep(1.0)
    assert np.array_equal(before, _joints(controller))
    assert "move_started" not in {event["trigger"] for event in case.record()}


@pytest.mark.hazard("H14", "H15")
def test_a_duplicated_tab_that_holds_the_same_permit_starts_no_second_motion(case, lift, controller, until) -> None:
    """Both tabs press: one motion at most, and once either lets go it ends, whatever the other does."""
    permit, newest = case.approve(lift(60.0), PIN), controller.wire()[-1].number
    with case.hold(permit) as first, case.hold(permit) as second:
        until(lambda: controller.state().tcp_speed_mm_s > 10.0 or first.is_over or second.is_over)
        released = first if second.is_over else second
        released.release()
        released.wait(5.0)  # where the other was refused, this one may have been about to start
        _comes_to_rest(controller, until)
    assert len([record for record in controller.wire(newest) if record.command == 3]) <= 1
    assert case.wait_for("safe_hold", "case_open")["chain"]["permit"] is None
    if case.status()["state"] == "safe_hold":
        case.command("acknowledged", guide="empty")


@pytest.mark.hazard("H15")
def test_a_button_that_was_pressed_for_an_earlier_permit_ends_no_newer_motion(case, lift, controller, until) -> None:
    """A socket opened under a permit that another has replaced, and silent since, says its first word."""
    earlier = case.hold(case.approve(lift(20.0), PIN))
    earlier.fall_silent()
    with earlier, case.hold(case.approve(lift(40.0), PIN)) as newer:
        until(lambda: controller.state().tcp_speed_mm_s > 10.0 or newer.is_over)
        earlier.release()
        assert earlier.wait(5.0).cause == "not_started"
        assert newer.wait(30.0).cause == "arrived"
