"""Each process killed or paused amid a motion: the arm stops, and nothing starts it again (H16, H17, H20)."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from robot.guard.child import GuardChild
from robot.guard.journal import EVENTS_FILE, read_lines
from robot.guard.messages import Fault, FaultKind, Phase
from simulator.controller import ControllerProcess, free_loopback_address
from tests.waiting import until

pytestmark = pytest.mark.real_time

WATCHDOG_S = 0.4  # 2.5 Hz
SCRIPT = Path(__file__).with_name("holding_parent.py")


class HoldingParent:
    """The process of `holding_parent.py`, its arm running."""

    def __init__(self, controller: ControllerProcess, journal_folder: Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, str(SCRIPT), controller.address, str(journal_folder)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        assert self.process.stdout is not None
        self.guard_id = int(self.process.stdout.readline())
        until(lambda: controller.state().tcp_speed_mm_s > 15.0, 3.0)

    def end(self) -> None:
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                pipe.close()
        self.process.send_signal(signal.SIGCONT)
        self.process.wait(15.0)
        until(lambda: not is_alive(self.guard_id), 10.0)


def is_alive(process_id: int) -> bool:
    try:
        os.kill(process_id, 0)
    except ProcessLookupError:
        return False
    try:
        return "\nState:\tZ" not in Path(f"/proc/{process_id}/status").read_text()
    except OSError:  # it was reaped meanwhile
        return False


def first_stop_after(controller: ControllerProcess, at_s: float) -> float:
    return min(record.at_s - at_s for record in controller.wire() if record.at_s >= at_s and record.text == "stop")


def stays_at_rest(controller: ControllerProcess) -> None:
    until(lambda: not controller.state().moving, 3.0)
    before = controller.state()
    time.sleep(0.6)
    after = controller.state()
    assert after.program == ""
    assert (before.joints_rad == after.joints_rad).all()


@pytest.fixture
def parent(controller: ControllerProcess, tmp_path: Path) -> Iterator[HoldingParent]:
    parent = HoldingParent(controller, tmp_path)
    yield parent
    parent.end()


@pytest.mark.hazard("H17")
def test_killed_service_stops_the_arm_at_once_and_the_guard_goes(
    parent: HoldingParent, controller: ControllerProcess, tmp_path: Path
) -> None:
    at_s = time.monotonic()
    parent.process.kill()
    stays_at_rest(controller)
    assert first_stop_after(controller, at_s) < 0.05
    until(lambda: not is_alive(parent.guard_id), 3.0)
    ended = read_lines(tmp_path / EVENTS_FILE)[-1]
    assert (ended["type"], ended["cause"], ended["at_rest"]) == ("motion_ended", "parent_lost", True)


@pytest.mark.hazard("H17")
def test_guard_goes_with_the_thread_that_started_it_before_any_pipe_closes(tmp_path: Path) -> None:
    started: list[GuardChild] = []

    def start() -> None:
        started.append(GuardChild(free_loopback_address(), tmp_path))
        assert started[0].read(15.0)

    starting = threading.Thread(target=start)
    starting.start()
    starting.join()
    [child] = started
    until(lambda: child.read(0.1) is None, 5.0)
    child.end(at_once=True)


@pytest.mark.hazard("H20")
def test_paused_service_is_silence_and_its_return_moves_nothing(
    parent: HoldingParent, controller: ControllerProcess
) -> None:
    at_s = time.monotonic()
    parent.process.send_signal(signal.SIGSTOP)
    until(lambda: not controller.state().moving, 2.0)
    assert first_stop_after(controller, at_s) < 0.3
    time.sleep(1.5)  # the guard goes on to write into a pipe that nobody reads
    parent.process.send_signal(signal.SIGCONT)
    stays_at_rest(controller)


@pytest.mark.hazard("H17")
def test_killed_guard_is_noticed_by_its_parent_which_stops_the_arm(bench) -> None:
    bench.move(step_mm=60.0)
    at_s = time.monotonic()
    os.kill(bench.client.process_id, signal.SIGKILL)
    bench.until(lambda: not bench.controller.state().moving, 2.0)
    assert bench.first_stop_after(at_s) < 0.1
    bench.told(Fault)
    assert bench.told(Fault).kind is FaultKind.GUARD_LOST
    bench.until(bench.sees_the_arm, 10.0)
    assert bench.status.phase is Phase.HELD  # the next guard; the heartbeats go on
    bench.stays_at_rest()


@pytest.mark.hazard("H17")
def test_controllers_watchdog_stops_the_arm_when_guard_and_service_are_gone(
    parent: HoldingParent, controller: ControllerProcess
) -> None:
    parent.process.send_signal(signal.SIGSTOP)
    os.kill(parent.guard_id, signal.SIGKILL)
    at_s = time.monotonic()
    until(lambda: not controller.state().moving, 2.0)
    stopped = [sample.at_s for sample in controller.samples(at_s) if sample.tcp_speed_mm_s == 0.0]
    assert min(stopped) - at_s < WATCHDOG_S + 0.2
    assert not [record for record in controller.wire() if record.at_s > at_s and record.text == "stop"]
    stays_at_rest(controller)


@pytest.mark.hazard("H20")
def test_paused_guard_feeds_no_watchdog_and_is_replaced(bench) -> None:
    bench.move(step_mm=60.0)
    frozen = bench.client.process_id
    os.kill(frozen, signal.SIGSTOP)
    at_s = time.monotonic()
    bench.until(lambda: not bench.controller.state().moving, 2.0)
    assert time.monotonic() - at_s < WATCHDOG_S + 0.3
    bench.until(lambda: bench.count(Fault) > 0, 5.0)
    bench.until(lambda: not is_alive(frozen), 2.0)
    bench.until(bench.sees_the_arm, 10.0)
    assert bench.status.phase is Phase.HELD
    bench.stays_at_rest()


@pytest.mark.hazard("H20")
def test_guard_that_wakes_up_late_stops_instead_of_going_on(bench) -> None:
    bench.move(step_mm=60.0)
    os.kill(bench.client.process_id, signal.SIGSTOP)
    time.sleep(0.5)
    os.kill(bench.client.process_id, signal.SIGCONT)
    bench.stays_at_rest()
    assert bench.status.phase is Phase.HELD


@pytest.mark.hazard("H17")
def test_guard_that_is_asked_to_end_again_and_again_ends(bench) -> None:
    bench.move(step_mm=60.0)
    guard = bench.client.process_id
    for _ in range(1000):  # each thread of a service that is killed asks once
        try:
            os.kill(guard, signal.SIGTERM)
        except ProcessLookupError:
            break
        time.sleep(0.0007)
    bench.until(lambda: not is_alive(guard), 5.0)
    bench.stays_at_rest()


def test_guard_asked_to_end_stops_the_arm_first(bench) -> None:
    bench.move(step_mm=60.0)
    at_s = time.monotonic()
    os.kill(bench.client.process_id, signal.SIGTERM)
    bench.until(lambda: not bench.controller.state().moving, 2.0)
    assert bench.first_stop_after(at_s) < 0.05
    bench.stays_at_rest()


def test_closing_the_client_stops_the_arm_and_ends_the_guard(bench) -> None:
    bench.move(step_mm=60.0)
    guard = bench.client.process_id
    bench.client.close()
    assert not is_alive(guard)
    bench.stays_at_rest()
