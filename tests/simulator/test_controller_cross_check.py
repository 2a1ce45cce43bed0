"""The controller as a client sees it that is not ur-rtde: framing, recipes, rates, and the same values as ur-rtde's."""

import time

import numpy as np
import pytest

from tests.simulator.rtde_client import InUseError, RtdeClient

pytestmark = pytest.mark.real_time

MOVE_LINEAR = 3
MOVE_INPUTS = ["input_int_register_0", *(f"input_double_register_{i}" for i in range(11))]


@pytest.fixture
def other(controller):
    with RtdeClient(controller.address) as client:
        yield client


def test_version_and_types_are_told(controller, other):
    assert other.version() == (3, 15, 8, 106339)
    other.subscribe("timestamp", "actual_q", "payload_cog", "robot_mode", "joint_mode", "actual_digital_input_bits")
    packet = other.read()
    assert packet["robot_mode"] == 7
    assert packet["joint_mode"] == (253,) * 6
    assert packet["actual_digital_input_bits"] == 0
    assert packet["payload_cog"] == pytest.approx((0.0, 0.0, 0.05))


@pytest.mark.parametrize(("rate_hz", "step_s"), [(125.0, 0.008), (25.0, 0.040)])
def test_packets_come_at_the_rate_that_was_asked_for(other, rate_hz, step_s):
    other.subscribe("timestamp", rate_hz=rate_hz)
    times_s = [other.read()["timestamp"] for _ in range(20)]
    assert np.diff(times_s) == pytest.approx(step_s)


def test_both_clients_read_the_same(controller, other, start_client):
    other.subscribe("actual_q", "actual_TCP_pose", "payload", "safety_status_bits", "robot_status_bits")
    packet, rtde = other.read(), start_client(controller, "receive")
    assert packet["actual_q"] == pytest.approx(rtde.receive("getActualQ"), abs=1e-12)
    assert packet["actual_TCP_pose"] == pytest.approx(rtde.receive("getActualTCPPose"), abs=1e-12)
    assert packet["payload"] == rtde.receive("getPayload")
    assert packet["safety_status_bits"] == rtde.receive("getSafetyStatusBits")
    assert packet["robot_status_bits"] == rtde.receive("getRobotStatus")


def test_speed_and_pose_on_the_wire_agree_during_a_motion(controller, other, start_client):
    client = start_client(controller, "control")
    other.subscribe("timestamp", "actual_TCP_pose", "actual_TCP_speed")
    client.control("moveL", [-0.4869, -0.10915, 0.411859, 2.221441469079183, 2.221441469079183, 0.0], 0.02, 0.5, True)
    packets = [other.read() for _ in range(100)]
    height_m = np.array([packet["actual_TCP_pose"][2] for packet in packets])
    speed_m_s = np.array([packet["actual_TCP_speed"][2] for packet in packets])
    assert np.diff(height_m) / 0.008 == pytest.approx(speed_m_s[1:], abs=1e-4)  # m/s
    assert speed_m_s.min() == pytest.approx(-0.02, abs=1e-4)


def test_inputs_of_the_running_client_are_not_to_be_had_and_are_free_once_it_left(
    controller, other, start_client, wait_until
):
    client = start_client(controller, "control")
    with pytest.raises(InUseError):
        other.claim(*MOVE_INPUTS)
    client.close()
    wait_until(lambda: controller.wire()[-1].kind == "disconnected")
    other.claim(*MOVE_INPUTS)
    other.write(MOVE_LINEAR, *(0.0,) * 11)
    wait_until(lambda: controller.wire()[-1].command == MOVE_LINEAR)


def test_inputs_without_a_program_move_nothing(controller, other):
    before = controller.state().joints_rad
    other.claim(*MOVE_INPUTS)
    other.write(MOVE_LINEAR, *(0.3,) * 11)
    time.sleep(0.3)
    assert np.array_equal(before, controller.state().joints_rad)
