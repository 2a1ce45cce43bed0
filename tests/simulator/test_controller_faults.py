"""Feedback that lies and connections that break, as the real client sees them."""

import math
import socket
import time

import numpy as np
import pytest

from simulator.controller import Fault
from simulator.controller.addresses import DASHBOARD_PORT, RTDE_PORT

pytestmark = pytest.mark.real_time

GOAL = [-0.4869, -0.10915, 0.411859, 2.221441469079183, 2.221441469079183, 0.0]


@pytest.fixture
def moving(controller, start_client):
    client = start_client(controller, "receive", "control")
    client.control("moveL", GOAL, 0.02, 0.5, True)
    time.sleep(0.2)
    return controller, client


def test_stopped_timestamp_stands_while_the_values_move(moving):
    controller, client = moving
    controller.inject(Fault.TIMESTAMP_STOPS)
    time.sleep(0.05)
    stamp, joints = client.receive("getTimestamp"), client.receive("getActualQ")
    time.sleep(0.2)
    assert client.receive("getTimestamp") == stamp
    assert client.receive("getActualQ") != joints


def test_frozen_values_stand_while_the_timestamp_and_the_arm_move(moving):
    controller, client = moving
    controller.inject(Fault.VALUES_FREEZE)
    time.sleep(0.05)
    stamp, joints, true = client.receive("getTimestamp"), client.receive("getActualQ"), controller.state().joints_rad
    time.sleep(0.2)
    assert client.receive("getTimestamp") > stamp
    assert client.receive("getActualQ") == joints
    assert not np.array_equal(controller.state().joints_rad, true)
    controller.clear(Fault.VALUES_FREEZE)
    time.sleep(0.05)
    assert client.receive("getActualQ") != joints


def test_values_turn_into_nan_and_back(moving):
    controller, client = moving
    controller.inject(Fault.VALUES_NAN)
    time.sleep(0.05)
    assert all(math.isnan(value) for value in client.receive("getActualTCPPose") + client.receive("getActualQ"))
    controller.clear()
    time.sleep(0.05)
    assert all(math.isfinite(value) for value in client.receive("getActualTCPPose") + client.receive("getActualQ"))


def stamps(controller, count):
    """Timestamps of successive packets, read without the client."""
    names = b"timestamp"
    with socket.create_connection((controller.address, RTDE_PORT), timeout=5.0) as connection:
        connection.sendall(b"\x00\x14O" + np.array([125.0], ">f8").tobytes() + names)
        connection.recv(100)
        connection.sendall(b"\x00\x03S")
        stream = connection.makefile("rb")
        stream.read(4)
        return [float(np.frombuffer(stream.read(12)[4:], ">f8")[0]) for _ in range(count)]


def test_packets_come_one_cycle_apart_and_out_of_order_on_request(controller):
    assert np.diff(stamps(controller, 20)) == pytest.approx(np.full(19, 0.008))
    controller.inject(Fault.PACKETS_OUT_OF_ORDER)
    steps = np.diff(stamps(controller, 20))
    assert steps.min() == pytest.approx(-0.008)
    assert steps.max() == pytest.approx(0.024)


def test_stopped_packets_leave_the_old_values(moving):
    controller, client = moving
    controller.inject(Fault.PACKETS_STOP)
    time.sleep(0.05)
    stamp = client.receive("getTimestamp")
    time.sleep(0.2)
    assert client.receive("getTimestamp") == stamp
    controller.clear()
    time.sleep(0.1)
    assert client.receive("getTimestamp") > stamp
    assert client.receive("isConnected") is True


def test_closed_rtde_connection_is_noticed_and_refused_until_cleared(controller, start_client, wait_until):
    client = start_client(controller, "receive")
    controller.inject(Fault.RTDE_CLOSED)
    wait_until(lambda: client.receive("isConnected") is False)
    with pytest.raises(OSError):
        socket.create_connection((controller.address, RTDE_PORT), timeout=1.0)
    controller.clear(Fault.RTDE_CLOSED)
    assert start_client(controller, "receive").receive("isConnected") is True


def test_closed_script_port_lets_a_new_upload_run_nothing(controller, start_client, wait_until):
    client = start_client(controller, "control")
    controller.inject(Fault.SCRIPT_PORT_CLOSED)
    client.control("stopScript")
    wait_until(lambda: controller.state().program == "")
    client.control("reuploadScript")
    time.sleep(0.2)
    assert controller.state().program == ""
    assert client.control("isProgramRunning") is False


def test_closed_dashboard_refuses_until_cleared(controller, start_client):
    client = start_client(controller, "dashboard")
    controller.inject(Fault.DASHBOARD_CLOSED)
    with pytest.raises(RuntimeError):
        client.dashboard("stop")
    controller.clear()
    start_client(controller, "dashboard").dashboard("stop")


def test_reset_connection_is_noticed_and_a_new_one_taken(controller, start_client, wait_until):
    with socket.create_connection((controller.address, RTDE_PORT), timeout=5.0) as connection:
        connection.sendall(b"\x00\x05V\x00\x02")
        connection.recv(100)
        controller.inject(Fault.RTDE_RESET)
        with pytest.raises(ConnectionResetError):
            connection.recv(100)
    assert start_client(controller, "receive").receive("isConnected") is True


def test_dripping_bytes_leave_the_old_values(moving):
    controller, client = moving
    controller.inject(Fault.BYTES_DRIP)
    time.sleep(0.05)
    stamp = client.receive("getTimestamp")
    time.sleep(0.2)
    assert client.receive("getTimestamp") == stamp  # a packet of a kilobyte takes eight seconds
    controller.clear()
    time.sleep(0.2)
    assert client.receive("getTimestamp") > stamp


def test_switched_off_controller_comes_back_without_power_and_with_a_new_clock(moving, start_client, wait_until):
    controller, _ = moving
    before = controller.state()
    controller.inject(Fault.SWITCHED_OFF)
    with pytest.raises(OSError):
        socket.create_connection((controller.address, RTDE_PORT), timeout=1.0)
    wait_until(lambda: controller.state().tcp_speed_mm_s == 0.0, 0.2)
    controller.clear()
    after = controller.state()
    assert (after.program, after.robot_mode.name) == ("", "POWER_OFF")
    assert after.controller_time_s < before.controller_time_s
    assert start_client(controller, "receive").receive("getRobotMode") == 3


def test_local_control_ends_the_program_and_takes_neither_uploads_nor_commands(moving, start_client, wait_until):
    controller, client = moving
    controller.inject(Fault.LOCAL_CONTROL)
    wait_until(lambda: controller.state().program == "" and not controller.state().moving)
    with socket.create_connection((controller.address, DASHBOARD_PORT), timeout=5.0) as connection:
        connection.sendall(b"is in remote control\n")
        wait_until(lambda: b"false" in connection.recv(1000))
    with pytest.raises(RuntimeError):
        start_client(controller, "dashboard").dashboard("stop")
    client.control("reuploadScript")
    time.sleep(0.2)
    assert controller.state().program == ""


def test_mute_handshake_hangs_the_client(controller, start_client):
    controller.inject(Fault.HANDSHAKE_MUTE)
    client = start_client(controller)
    client.send("receive", "open")
    with pytest.raises(TimeoutError):
        client.answer(1.0)


def test_ignored_upload_runs_nothing(controller, start_client, wait_until):
    client = start_client(controller, "control")
    client.control("stopScript")
    wait_until(lambda: controller.state().program == "")
    controller.inject(Fault.IGNORES_UPLOADS)
    client.control("reuploadScript")
    time.sleep(0.2)
    assert client.control("isProgramRunning") is False


def test_force_step_is_reported(controller, start_client):
    client = start_client(controller, "receive")
    assert client.receive("getActualTCPForce")[2] == pytest.approx(5.0, abs=12.0)  # N: six times the noise
    controller.inject(Fault.FORCE_STEP)
    time.sleep(0.05)
    assert client.receive("getActualTCPForce")[2] == pytest.approx(-55.0, abs=12.0)


def test_reduced_mode_is_reported_and_moves_on(moving, wait_until):
    controller, client = moving
    controller.inject(Fault.REDUCED_MODE)
    wait_until(lambda: client.receive("getSafetyStatusBits") == 1 << 1)
    wait_until(lambda: abs(client.receive("getActualTCPPose")[2] - GOAL[2]) < 1e-7)


def test_move_that_falls_short_ends_like_any_other_elsewhere(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    controller.inject(Fault.FALLS_SHORT)
    client.control("moveL", GOAL, 0.02, 0.5, True)
    wait_until(lambda: client.control("getAsyncOperationProgress") == -1)
    assert client.receive("getActualTCPPose")[2] == pytest.approx(GOAL[2] + 0.1 * 0.02, abs=1e-6)


def test_client_that_reads_nothing_is_dropped_alone(start_controller, start_client, wait_until):
    controller = start_controller(version=(5, 11, 8, 1000))  # 500 Hz fill the buffers in a shorter test
    client = start_client(controller, "receive")
    names = ",".join([f"output_double_register_{i}" for i in range(48)] + ["actual_q"] * 20).encode()
    with socket.socket() as deaf:
        deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        deaf.connect((controller.address, RTDE_PORT))
        deaf.sendall((11 + len(names)).to_bytes(2, "big") + b"O" + np.array([500.0], ">f8").tobytes() + names)
        deaf.sendall(b"\x00\x03S")
        wait_until(lambda: controller.wire()[-1].kind == "disconnected", 30.0)
    assert client.receive("isConnected") is True
