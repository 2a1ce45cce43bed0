"""The unmodified ur-rtde client is accepted on all three ports, and sees a UR5 with a CB3 controller."""

import socket
import struct
import time

import numpy as np
import pytest

from simulator.controller import ControllerProcess, ControllerSettings
from simulator.controller.addresses import PORTS, RTDE_PORT

pytestmark = pytest.mark.real_time

GOAL = [-0.4869, -0.10915, 0.40, 2.221441, 2.221441, 0.0]


def test_all_three_interfaces_connect_and_the_control_script_runs(controller, start_client):
    client = start_client(controller, "dashboard", "receive", "control")
    assert client.dashboard("polyscopeVersion").startswith("3.15.8")
    assert client.dashboard("getRobotModel") == "UR5"
    assert client.dashboard("robotmode") == "Robotmode: RUNNING"
    assert client.dashboard("safetymode") == "Safetymode: NORMAL"
    assert client.dashboard("running") is True
    assert client.control("isProgramRunning") is True
    assert client.receive("getRuntimeState") == 2
    assert client.receive("getSafetyStatusBits") == 1
    assert client.receive("getRobotStatus") == 3


def test_reported_pose_is_the_published_one_of_the_joints(controller, start_client):
    client = start_client(controller, "receive")
    assert client.receive("getActualQ") == pytest.approx(np.radians([0, -90, 90, -90, -90, 0]))
    expected = [-0.4869, -0.10915, 0.431859, 2.221441, 2.221441, 0.0]
    assert client.receive("getActualTCPPose") == pytest.approx(expected, abs=1e-6)  # m, rad: the published digits


def test_controller_time_advances_with_the_machine_at_125_hz(controller, start_client):
    client = start_client(controller, "receive")
    before, before_s = controller.state(), time.monotonic()
    time.sleep(2.0)
    after, elapsed_s = controller.state(), time.monotonic() - before_s
    assert after.controller_time_s - before.controller_time_s == pytest.approx((after.cycles - before.cycles) * 0.008)
    # two cycles of rounding; a held process counts as time that the controller stood still
    stalled_s = after.stalled_s - before.stalled_s
    assert after.controller_time_s - before.controller_time_s == pytest.approx(elapsed_s - stalled_s, abs=0.03)
    assert client.receive("getTimestamp") == pytest.approx(controller.state().controller_time_s, abs=0.2)


def test_tcp_and_payload_are_read_back_as_set(start_controller, start_client):
    flange_from_tcp = np.eye(4)
    flange_from_tcp[:3, 3] = [1.0, -2.0, 180.0]
    controller = start_controller(flange_from_tcp=flange_from_tcp)
    client = start_client(controller, "receive", "control")
    assert client.control("getTCPOffset") == pytest.approx([0.001, -0.002, 0.18, 0, 0, 0])
    assert client.control("setTcp", [0.0, 0.01, 0.2, 0.0, 0.1, 0.0]) is True
    assert client.control("getTCPOffset") == pytest.approx([0.0, 0.01, 0.2, 0.0, 0.1, 0.0])
    assert client.control("setPayload", 1.5, [0.0, 0.0, 0.06]) is True
    time.sleep(0.1)
    assert client.receive("getPayload") == pytest.approx(1.5)
    assert client.receive("getPayloadCog") == pytest.approx([0.0, 0.0, 0.06])


def test_kinematic_questions_are_answered(controller, start_client):
    client = start_client(controller, "receive", "control")
    joints = client.control("getInverseKinematics", GOAL)
    assert client.control("getForwardKinematics", joints, [0, 0, 0.1, 0, 0, 0])[2] == pytest.approx(0.3, abs=1e-6)
    assert client.control("getInverseKinematicsHasSolution", GOAL) is True
    assert client.control("getInverseKinematicsHasSolution", [2.0, 0, 0, 0, 0, 0]) is False
    assert client.control("poseTrans", [0, 0, 1, 0, 0, 0], [0, 1, 0, 0, 0, 0]) == pytest.approx([0, 1, 1, 0, 0, 0])
    assert client.control("isSteady") is True


def test_second_control_client_is_refused_while_the_first_writes_the_registers(controller, start_client):
    start_client(controller, "control")
    with pytest.raises(RuntimeError, match="already in use"):
        start_client(controller, "control")


def test_next_client_connects_after_the_first_one_was_killed(controller, start_client):
    start_client(controller, "control").close()
    assert start_client(controller, "control").control("isProgramRunning") is True


def test_custom_script_function_is_tolerated(controller, start_client, wait_until):
    client = start_client(controller, "control")
    assert client.control("sendCustomScriptFunction", "blink", "sleep(0.1)\n") is True
    wait_until(lambda: controller.state().program == "rtde_control")
    assert client.control("isProgramRunning") is True


def test_upper_range_of_registers_is_followed(controller, start_client, wait_until):
    upper = start_client(controller, "receive", "upper_control")
    assert upper.call("upper_control", "getTCPOffset") == pytest.approx([0.0] * 6)
    assert upper.call("upper_control", "moveL", GOAL, 0.1, 0.5, True) is True
    wait_until(lambda: upper.receive("getActualTCPPose")[2] == pytest.approx(GOAL[2], abs=1e-7))
    wait_until(lambda: upper.call("upper_control", "getAsyncOperationProgress") < 0)


def test_vector_inputs_are_recorded_and_move_nothing(controller):
    names, force = b"input_int_register_0,external_force_torque", np.arange(6.0)
    with socket.create_connection((controller.address, RTDE_PORT), timeout=5.0) as connection:
        connection.sendall(struct.pack(">HB", 3 + len(names), 73) + names)
        recipe = connection.recv(100)[3]
        payload = struct.pack(">Bi6d", recipe, 0, *force)
        connection.sendall(struct.pack(">HB", 3 + len(payload), 85) + payload)
        time.sleep(0.1)
    assert [record.text for record in controller.wire() if record.kind == "input"] == ["0 1 2 3 4 5"]


def test_version_5_controller_is_read_at_500_hz(start_controller, start_client):
    controller = start_controller(version=(5, 11, 8, 1000))
    client = start_client(controller, "receive", "control")
    assert client.control("getTCPOffset") == pytest.approx([0.0] * 6)
    before = controller.state()
    time.sleep(0.5)
    assert controller.state().cycles - before.cycles > 150  # 250 on an idle machine


def test_address_in_use_is_an_error_at_once(controller):
    with pytest.raises(OSError, match="in use"):
        ControllerProcess(ControllerSettings(controller.address))


def test_two_controllers_move_independently(start_controller, start_client, wait_until):
    first, second = start_controller(), start_controller()
    one, other = start_client(first, "control"), start_client(second, "control")
    assert one.control("moveL", GOAL, 0.05, 0.5, True) is True
    wait_until(lambda: first.state().tcp_speed_mm_s > 10.0)
    assert second.state().tcp_speed_mm_s == 0.0
    assert other.control("isSteady") is True
    assert [record for record in second.wire() if record.command == 3] == []


def test_garbage_ends_the_connection_and_nothing_else(controller, start_client):
    for port, garbage in zip(PORTS, (b"\xff" * 100_000, b"\xff" * 100_000, b"\x00\x00\x00\xff\xff"), strict=True):
        with socket.create_connection((controller.address, port), timeout=5.0) as connection:
            connection.sendall(garbage)
    assert start_client(controller, "dashboard", "receive", "control").control("isProgramRunning") is True


def test_unknown_output_variable_is_answered_not_found(controller):
    payload = struct.pack(">d", 125.0) + b"timestamp,actual_q,no_such_thing"
    with socket.create_connection((controller.address, RTDE_PORT), timeout=5.0) as connection:
        connection.sendall(struct.pack(">HB", 3 + len(payload), 79) + payload)
        answer = connection.recv(200)
    assert answer[4:] == b"DOUBLE,VECTOR6D,NOT_FOUND"
