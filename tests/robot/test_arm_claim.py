"""One orchestrator per arm (H19): a register of the controller, held by a connection that dies with its holder."""

import socket
import struct
import subprocess
import sys
import threading
import time

import pytest

from robot.arm_claim import ArmClaim
from robot.errors import ArmClaimedError, ArmUnreachableError, ControllerRefusedError
from robot.guard.messages import Phase
from robot.rtde_frames import RTDE_PORT
from robot.ur5 import UR5
from simulator.controller import Fault, free_loopback_address

_HOLD = """
import sys, time
from robot.arm_claim import ArmClaim
claim = ArmClaim(sys.argv[1])
claim.take()
print("held", flush=True)
time.sleep(60)
"""


def _comes_free(claim: ArmClaim) -> None:
    """Once the controller has seen the holder's connection close."""
    end_s = time.monotonic() + 3.0
    while True:
        try:
            return claim.take()
        except ArmClaimedError:
            assert time.monotonic() < end_s
            time.sleep(0.02)


def _connections(controller) -> int:
    return sum(one.text == "connected" for one in controller.wire())


@pytest.mark.hazard("H19")
def test_a_second_claim_is_refused_until_the_first_is_given_up(controller) -> None:
    first, second = ArmClaim(controller.address), ArmClaim(controller.address)
    first.take()
    with pytest.raises(ArmClaimedError):
        second.take()
    first.give_up()
    _comes_free(second)
    second.give_up()


def test_a_claim_that_is_held_is_not_taken_again(controller) -> None:
    claim = ArmClaim(controller.address)
    claim.take()
    before = _connections(controller)
    claim.take()
    assert _connections(controller) == before
    claim.give_up()


def test_a_killed_holder_frees_the_arm_at_once(controller) -> None:
    command = [sys.executable, "-c", _HOLD, controller.address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout.readline() == "held\n"
        claim = ArmClaim(controller.address)
        with pytest.raises(ArmClaimedError):
            claim.take()
        holder.kill()
        holder.wait()
        _comes_free(claim)
        claim.give_up()


def test_a_claim_that_the_controller_cut_off_is_taken_anew(controller) -> None:
    claim = ArmClaim(controller.address)
    claim.take()
    controller.inject(Fault.RTDE_CLOSED)
    controller.clear()
    _comes_free(claim)
    with pytest.raises(ArmClaimedError):
        ArmClaim(controller.address).take()
    claim.give_up()


def test_any_other_client_of_the_register_is_respected(controller) -> None:
    with socket.create_connection((controller.address, RTDE_PORT), 2.0) as other:
        names = b"input_int_register_47,"
        other.sendall(struct.pack(">HBH", 5, 86, 2) + struct.pack(">HB", 3 + len(names), 73) + names)
        time.sleep(0.1)
        with pytest.raises(ArmClaimedError):
            ArmClaim(controller.address).take()


def test_an_arm_that_is_away_or_mute_is_nobody_s(controller) -> None:
    with pytest.raises(ArmUnreachableError):
        ArmClaim(free_loopback_address()).take()
    controller.inject(Fault.HANDSHAKE_MUTE)
    began_s = time.monotonic()
    with pytest.raises(ArmUnreachableError):
        ArmClaim(controller.address).take()
    assert time.monotonic() - began_s < 2.0


@pytest.mark.parametrize(
    "answers",
    [
        struct.pack(">HBB", 4, 86, 0),
        struct.pack(">HBB", 4, 86, 1) + struct.pack(">HBB", 13, 73, 0) + b"NOT_FOUND",
    ],
)
def test_a_controller_without_that_version_or_register_is_refused_with_a_reason(answers: bytes) -> None:
    address = free_loopback_address()
    with socket.create_server((address, RTDE_PORT)) as server:

        def serve() -> None:
            with server.accept()[0] as connection:
                connection.sendall(struct.pack(">HB", 7, 77) + b"text" + answers)
                connection.recv(4096)

        serving = threading.Thread(target=serve)
        serving.start()
        with pytest.raises(ControllerRefusedError):
            ArmClaim(address).take()
        serving.join()


@pytest.mark.hazard("H19")
def test_a_second_driver_neither_connects_nor_stops_what_the_first_one_runs(controller) -> None:
    first, second = UR5(controller.address), UR5(controller.address)
    assert first.connect()
    stops = sum(one.text == "stop" for one in controller.wire())
    assert not second.connect()
    assert sum(one.text == "stop" for one in controller.wire()) == stops
    first.close()


@pytest.mark.real_time
def test_the_guard_of_a_claimed_arm_stays_held_and_sees_nothing(controller, make_bench, tmp_path) -> None:
    claim = ArmClaim(controller.address)
    claim.take()
    bench = make_bench(controller.address, tmp_path / "journal")
    bench.client.start()
    bench.until(lambda: bench.client.status is not None, 10.0)
    time.sleep(1.5)  # it tries each second
    assert (bench.status.phase, bench.status.connected) == (Phase.HELD, False)
    claim.give_up()
    bench.until(lambda: bench.status.connected, 10.0)
