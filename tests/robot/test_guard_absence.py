"""A guard without a controller, and a client without a guard."""

import time
from pathlib import Path

import pytest

from robot.dashboard import DashboardLink, stop_by_dashboard
from robot.errors import GuardDownError
from robot.guard.child import GuardChild
from robot.guard.client import GuardClient, GuardConfig
from robot.guard.messages import Heartbeat, Phase
from simulator.controller import ControllerProcess, ControllerSettings, Fault, free_loopback_address

pytestmark = pytest.mark.real_time


def test_guard_without_a_controller_says_so_and_finds_it_when_it_comes(make_bench, tmp_path: Path) -> None:
    address = free_loopback_address()
    bench = make_bench(address, tmp_path)
    bench.client.start()
    bench.until(lambda: bench.client.status is not None, 10.0)
    assert not bench.status.connected
    assert bench.status.arm is None
    assert bench.status.phase is Phase.HELD
    with ControllerProcess(ControllerSettings(address=address)):
        bench.until(bench.sees_the_arm, 10.0)
        assert bench.status.arm is not None


def test_guard_survives_a_controller_that_is_switched_off(make_bench, tmp_path: Path) -> None:
    with ControllerProcess(ControllerSettings(address=free_loopback_address())) as controller:
        bench = make_bench(controller.address, tmp_path)
        bench.start()
        guard = bench.client.process_id
    bench.until(lambda: not bench.status.connected, 5.0)
    with ControllerProcess(ControllerSettings(address=controller.address)):
        bench.until(bench.sees_the_arm, 15.0)
        assert bench.client.process_id == guard


@pytest.mark.parametrize("fault", [Fault.HANDSHAKE_MUTE, Fault.BYTES_DRIP])
def test_guard_goes_on_telling_beside_a_controller_that_answers_too_little(make_bench, tmp_path: Path, fault) -> None:
    """It asks for the arm each second, and never gets as far as the library's constructor, which would hold it up."""
    with ControllerProcess(ControllerSettings(address=free_loopback_address())) as controller:
        controller.inject(fault)
        bench = make_bench(controller.address, tmp_path)
        bench.client.start()
        bench.until(lambda: bench.client.status is not None, 15.0)
        guard = bench.client.process_id
        bench.until(lambda: bench.status.sequence >= 3, 6.0)
        assert not bench.status.connected
        controller.clear()
        bench.until(bench.sees_the_arm, 15.0)
        assert bench.client.process_id == guard


def test_stop_without_a_controller_returns_and_raises_nothing() -> None:
    address = free_loopback_address()
    assert not stop_by_dashboard(address, 0.2)
    assert not DashboardLink(address).send_stop()


def test_kept_dashboard_connection_is_opened_anew_after_it_was_closed_from_afar(controller: ControllerProcess) -> None:
    link = DashboardLink(controller.address)
    assert link.send_stop()
    try:
        controller.inject(Fault.DASHBOARD_CLOSED)
        give_up = time.monotonic() + 2.0
        while link.send_stop():  # until the close has come through
            assert time.monotonic() < give_up
        controller.clear()
        assert link.send_stop()
    finally:
        link.close()


def test_client_without_a_guard_refuses_motion_and_survives_the_rest(move, tmp_path: Path) -> None:
    client = GuardClient(GuardConfig(free_loopback_address(), tmp_path), lambda event: None)
    with pytest.raises(GuardDownError):
        client.begin_move(move)
    client.heartbeat(Heartbeat("permit-1", 1, "none", held=True))
    assert not client.acknowledge()
    assert not client.stop("asked")
    client.close()
    assert client.status is None


def test_listener_that_fails_does_not_end_the_supervision(controller: ControllerProcess, tmp_path: Path) -> None:
    heard = []

    def fail(event: object) -> None:
        heard.append(event)
        raise RuntimeError("a closed event loop")

    client = GuardClient(GuardConfig(controller.address, tmp_path), fail)
    client.start()
    deadline_s = time.monotonic() + 15.0
    while len(heard) < 10 and time.monotonic() < deadline_s:
        time.sleep(0.01)
    assert len(heard) >= 10
    client.close()


def test_guard_that_cannot_be_spawned_is_spawned_later(make_bench, tmp_path: Path, monkeypatch) -> None:
    spawn, attempts = GuardChild, []

    def fail_once(*arguments: object) -> GuardChild:
        attempts.append(arguments)
        if len(attempts) == 1:
            raise BlockingIOError("no process left")
        return spawn(*arguments)

    monkeypatch.setattr("robot.guard.client.GuardChild", fail_once)
    bench = make_bench(free_loopback_address(), tmp_path)
    bench.client.start()
    bench.until(lambda: bench.client.status is not None, 10.0)
    assert len(attempts) == 2
