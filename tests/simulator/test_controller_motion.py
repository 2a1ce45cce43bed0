"""Motions commanded by the real client: ramps, straightness, arrival, stops, and where the arm truly stands."""

import time

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simulator.controller import ArmTruth

pytestmark = pytest.mark.real_time

START = [-0.4869, -0.10915, 0.431859, 2.221441469079183, 2.221441469079183, 0.0]
LOWER = [-0.4769, -0.10915, 0.411859, 2.221441469079183, 2.221441469079183, 0.0]
CYCLE_S = 0.008


def travelled(samples):
    """Times (n,) s, TCP positions (n, 3) mm and speeds (n,) mm/s of the cycles."""
    return (
        np.array([sample.controller_time_s for sample in samples]),
        np.array([sample.tcp_in_base_mm for sample in samples]),
        np.array([sample.tcp_speed_mm_s for sample in samples]),
    )


def arrived(client, goal):
    pose, speed = client.receive("getActualTCPPose"), client.receive("getActualTCPSpeed")
    return np.linalg.norm(np.subtract(pose[:3], goal[:3])) < 1e-6 and max(map(abs, speed)) == 0.0


def test_linear_move_keeps_its_line_its_speed_and_its_acceleration(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    started_s = time.monotonic()
    assert client.control("moveL", LOWER, 0.02, 0.08, True) is True
    wait_until(lambda: arrived(client, LOWER))
    times, points, speeds = travelled(controller.samples(started_s))
    moving = np.flatnonzero(speeds)
    along = (np.array(LOWER[:3]) - START[:3]) * 1000.0
    from_line = np.linalg.norm(np.cross(points - points[0], along), axis=1) / np.linalg.norm(along)
    assert from_line.max() < 1e-5  # mm: the inverse kinematics' tolerance
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1) / CYCLE_S
    assert steps.max() == pytest.approx(20.0, abs=1e-3)  # mm/s: reached and not exceeded
    assert np.abs(np.diff(steps)).max() / CYCLE_S < 80.0 + 0.1  # mm/s2
    # 22.36 mm at 20 mm/s with two flanks of 0.25 s take 1.368 s
    assert times[moving[-1]] - times[moving[0]] == pytest.approx(22.3607 / 20.0 + 0.25, abs=3 * CYCLE_S)


def test_turn_goes_in_step_with_the_shift(controller, start_client, wait_until):
    turned = Rotation.from_rotvec([0.0, 0.0, 0.1]) * Rotation.from_rotvec(START[3:])
    goal = [*LOWER[:3], *turned.as_rotvec()]
    client = start_client(controller, "receive", "control")
    client.control("moveL", goal, 0.02, 0.5, True)
    for _ in range(20):
        pose = np.array(client.receive("getActualTCPPose"))
        shift = np.linalg.norm(pose[:3] - START[:3]) / np.linalg.norm(np.subtract(LOWER[:3], START[:3]))
        turn = (Rotation.from_rotvec(pose[3:]) * Rotation.from_rotvec(START[3:]).inv()).magnitude() / 0.1
        assert shift == pytest.approx(turn, abs=1e-5)
        time.sleep(0.05)
    wait_until(lambda: arrived(client, goal))


def test_status_word_names_the_operation_and_tells_its_end(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    fresh = {"running": False, "operation": 0, "changes": 1, "progress": -1}  # the client turns 0x10000 into this
    assert client.control("getAsyncOperationProgressEx") == fresh
    client.control("moveL", LOWER, 0.05, 0.5, True)
    wait_until(lambda: client.control("getAsyncOperationProgressEx")["operation"] == 1)
    assert client.control("getAsyncOperationProgress") == 0
    wait_until(lambda: arrived(client, LOWER))
    wait_until(lambda: client.control("getAsyncOperationProgress") == -1)
    assert client.control("getAsyncOperationProgressEx")["changes"] == 3


def test_joint_move_arrives_with_all_joints_in_step(controller, start_client, wait_until):
    goal = np.radians([10, -80, 85, -95, -88, 5]).tolist()
    client = start_client(controller, "receive", "control")
    client.control("moveJ", goal, 0.2, 0.5, True)
    wait_until(lambda: 0.01 < controller.state().joints_rad[0] < 0.1)
    done = (controller.state().joints_rad - np.radians([0, -90, 90, -90, -90, 0])) / np.radians([10, 10, -5, -5, 2, 5])
    assert done == pytest.approx(np.full(6, done[0]))
    wait_until(lambda: np.allclose(client.receive("getActualQ"), goal, atol=1e-9))
    wait_until(lambda: np.abs(client.receive("getActualQd")).max() == 0.0)


def test_stop_along_the_line_ends_the_motion_within_its_deceleration(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    client.control("moveL", LOWER, 0.02, 0.5, True)
    wait_until(lambda: controller.state().tcp_speed_mm_s == pytest.approx(20.0, rel=1e-3))
    client.control("stopL", 0.5, True)
    wait_until(lambda: controller.state().tcp_speed_mm_s == 0.0)
    stop_s = next(record.at_s for record in controller.wire() if record.command == 33)
    _, points, _ = travelled(controller.samples(stop_s))
    assert np.linalg.norm(points[-1] - points[0]) < 20.0**2 / (2 * 500.0) + 2 * 20.0 * CYCLE_S + 0.01  # mm
    stopped_at = client.receive("getActualTCPPose")
    time.sleep(0.2)
    assert client.receive("getActualTCPPose") == stopped_at
    assert client.control("getAsyncOperationProgress") < 0


def test_joint_beyond_its_range_stops_protectively(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    controller.teleport(np.radians([0, -90, 90, -90, -90, 359]))
    client.control("moveJ", np.radians([0, -90, 90, -90, -90, 362]).tolist(), 0.2, 0.5, True)
    wait_until(lambda: client.receive("isProtectiveStopped"))
    assert client.receive("getActualQ")[5] <= 2 * np.pi


def test_new_move_during_a_move_starts_from_rest(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    started_s = time.monotonic()
    client.control("moveL", LOWER, 0.02, 0.5, True)
    wait_until(lambda: controller.state().tcp_speed_mm_s == pytest.approx(20.0, rel=1e-3))
    client.control("moveL", START, 0.02, 0.5, True)
    wait_until(lambda: arrived(client, START))
    _, points, _ = travelled(controller.samples(started_s))
    velocities = np.diff(points, axis=0) / CYCLE_S
    assert np.linalg.norm(np.diff(velocities, axis=0), axis=1).max() / CYCLE_S < 500.0 + 0.1  # mm/s2: no jump


def test_command_during_a_blocking_move_is_reported_done_but_does_nothing(controller, start_client, wait_until):
    blocked, other = start_client(controller, "control"), start_client(controller, "receive")
    blocked.send("control", "moveL", LOWER, 0.02, 0.5)
    wait_until(lambda: controller.state().tcp_speed_mm_s > 15.0)
    assert other.receive("getRuntimeState") == 2
    assert blocked.answer() is True
    assert arrived(other, LOWER)


def test_unreachable_goal_kills_the_program(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    client.control("moveL", [1.5, 0.0, 0.4, 0.0, 0.0, 0.0], 0.02, 0.5, True)
    wait_until(lambda: not client.control("isProgramRunning"))
    assert controller.state().program == ""
    assert arrived(client, START)


def test_path_moves_are_read_from_the_injected_script(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    middle = [*START[:2], START[2] - 0.005, *START[3:]]
    path = [[*middle, 0.05, 0.5, 0.0], [*LOWER, 0.05, 0.5, 0.0]]
    assert client.control("moveL", path, True) is True
    wait_until(lambda: client.control("getAsyncOperationProgress") == 1)
    wait_until(lambda: arrived(client, LOWER))


def test_speed_slider_slows_the_motion_down(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    controller.set_speed_scaling(0.25)
    client.control("moveL", LOWER, 0.02, 0.5, True)
    wait_until(lambda: controller.state().tcp_speed_mm_s == pytest.approx(5.0, rel=1e-3))
    assert client.receive("getSpeedScaling") == 0.25
    controller.set_speed_scaling(1.0)
    wait_until(lambda: controller.state().tcp_speed_mm_s == pytest.approx(20.0, rel=1e-3))


def test_jog_moves_the_arm_without_a_program(controller, start_client, wait_until):
    client = start_client(controller, "receive")
    controller.jog_linear(np.array([0.0, 0.0, -5.0]))
    wait_until(lambda: client.receive("getActualTCPPose")[2] == pytest.approx(START[2] - 0.005, abs=1e-7))
    assert client.receive("getRuntimeState") == 1
    controller.jog(np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.05]))
    wait_until(lambda: client.receive("getActualQ")[5] == pytest.approx(0.05, abs=1e-7))


def test_jog_is_refused_while_a_program_is_loaded(controller, start_client):
    start_client(controller, "control")
    with pytest.raises(ValueError, match="program"):
        controller.jog(np.full(6, 0.01))


def test_push_is_seen_by_the_encoders_and_keeps_the_arrival(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    before = controller.state()
    controller.push(np.array([0.1, 0.0, 0.0]))
    wait_until(lambda: client.receive("getActualTCPPose")[0] == pytest.approx(START[0] + 0.0001, abs=1e-8))
    after = controller.state()
    true_shift = after.base_from_flange_true[:3, 3] - before.base_from_flange_true[:3, 3]
    assert true_shift == pytest.approx([0.1, 0.0, 0.0], abs=0.005)  # mm: the planted angles turn a small step little


def test_each_arrival_truly_stands_a_little_elsewhere_and_stays_there(start_controller, wait_until):
    truth = ArmTruth(kinematic_error_mm=0.0, repeatability_mm=0.1)
    controller = start_controller(truth=truth)
    places = []
    for step in (0.05, -0.05) * 6:
        controller.jog(np.array([0.0, 0.0, 0.0, step, 0.0, 0.0]), 2.0)
        wait_until(lambda: not controller.state().moving)
        state = controller.state()
        places.append(state.base_from_flange_true[:3, 3] - state.base_from_flange_nominal[:3, 3])
        assert np.array_equal(controller.state().base_from_flange_true, state.base_from_flange_true)
    spread_mm = np.linalg.norm(places, axis=1)
    assert np.sqrt(np.mean(spread_mm**2)) == pytest.approx(0.1, rel=0.5)  # of twelve draws
    assert len({tuple(place) for place in places}) == len(places)


def test_true_arm_is_half_a_millimetre_from_the_reported_one(controller):
    state = controller.state()
    distance_mm = np.linalg.norm(state.base_from_flange_true[:3, 3] - state.base_from_flange_nominal[:3, 3])
    assert 0.2 < distance_mm < 1.0


def test_teleported_arm_is_at_rest_elsewhere(controller, start_client, wait_until):
    client = start_client(controller, "receive")
    controller.teleport(np.radians([20, -80, 80, -90, -90, 0]))
    wait_until(lambda: client.receive("getActualQ")[0] == pytest.approx(np.radians(20)))
    assert np.abs(client.receive("getActualQd")).max() == 0.0
