"""Stops by the controller, their release, and the old motion that waits for a careless `play`."""

import time

import numpy as np
import pytest

from simulator.controller import Fault, PowerAction, RobotMode, RuntimeState, SafetyMode, WatchdogOutcome

pytestmark = pytest.mark.real_time

START = [-0.4869, -0.10915, 0.431859, 2.221441469079183, 2.221441469079183, 0.0]
FAR = [-0.4869, -0.10915, 0.371859, 2.221441469079183, 2.221441469079183, 0.0]
UNLOCK_DELAY_S = 5.0
SOON_S = 0.2  # of a controller that lets go sooner than a real one, where that is not what is tested


@pytest.fixture
def moving(start_controller, start_client, wait_until):
    """A controller whose arm is on its way at 20 mm/s, and the client that sent it there."""

    def start(**settings):
        controller = start_controller(**settings)
        client = start_client(controller, "dashboard", "receive", "control")
        client.control("moveL", FAR, 0.02, 0.5, True)
        wait_until(lambda: controller.state().tcp_speed_mm_s == pytest.approx(20.0, rel=1e-3))
        return controller, client

    return start


def at_rest(controller):
    return controller.state().tcp_speed_mm_s == 0.0


def unlock(controller, client, wait_until):
    """Take the cause away and wait until the dashboard lets go."""
    controller.clear()
    time.sleep(SOON_S)
    client.dashboard("unlockProtectiveStop")
    wait_until(lambda: client.receive("getSafetyMode") == 1)


def test_protective_stop_brings_the_arm_to_rest_and_pauses_the_program(moving, wait_until):
    controller, client = moving()
    before = controller.state()
    controller.inject(Fault.PROTECTIVE_STOP)
    wait_until(lambda: at_rest(controller))
    moved_mm = np.linalg.norm(
        controller.state().base_from_flange_nominal[:3, 3] - before.base_from_flange_nominal[:3, 3]
    )
    assert moved_mm < 5.0  # 1 mm of braking and the delay of this test's own calls
    assert client.receive("isProtectiveStopped") is True
    assert client.receive("getSafetyStatusBits") == 1 << 2 | 1 << 10
    assert client.receive("getRuntimeState") == RuntimeState.PAUSED
    assert client.receive("getRobotStatus") == 3  # power, and a program that could go on
    assert client.dashboard("programState") == "PAUSED rtde_control"


def test_play_after_unlock_resumes_the_old_motion(moving, wait_until):
    controller, client = moving(unlock_delay_s=SOON_S)
    controller.inject(Fault.PROTECTIVE_STOP)
    wait_until(lambda: at_rest(controller))
    unlock(controller, client, wait_until)
    client.dashboard("play")
    wait_until(lambda: client.receive("getActualTCPPose")[2] == pytest.approx(FAR[2], abs=1e-7))


def test_new_upload_after_unlock_abandons_the_old_motion(moving, wait_until):
    controller, client = moving(unlock_delay_s=SOON_S)
    controller.inject(Fault.PROTECTIVE_STOP)
    wait_until(lambda: at_rest(controller))
    unlock(controller, client, wait_until)
    stopped_at = controller.state().joints_rad
    assert client.control("reuploadScript") is True
    wait_until(lambda: client.receive("getRuntimeState") == RuntimeState.PLAYING)
    time.sleep(0.3)
    assert np.array_equal(controller.state().joints_rad, stopped_at)
    assert client.control("moveL", START, 0.05, 0.5, True) is True
    wait_until(lambda: client.receive("getActualTCPPose")[2] == pytest.approx(START[2], abs=1e-7))


def test_upload_while_stopped_runs_nothing(moving, wait_until):
    controller, client = moving()
    controller.inject(Fault.PROTECTIVE_STOP)
    wait_until(lambda: at_rest(controller))
    client.dashboard("stop")
    client.control("reuploadScript")
    time.sleep(0.2)
    assert controller.state().program == ""
    assert client.control("isProgramRunning") is False


def test_protective_stop_can_stop_the_program_instead(moving, wait_until):
    controller, client = moving(protective_stop_pauses=False, unlock_delay_s=SOON_S)
    controller.inject(Fault.PROTECTIVE_STOP)
    wait_until(lambda: client.receive("getRuntimeState") == RuntimeState.STOPPED)
    unlock(controller, client, wait_until)
    with pytest.raises(RuntimeError):
        client.dashboard("play")
    assert at_rest(controller)


def test_unlock_is_refused_within_five_seconds_and_while_the_cause_lasts(controller, start_client, wait_until):
    client = start_client(controller, "dashboard", "receive")
    controller.inject(Fault.PROTECTIVE_STOP)
    wait_until(lambda: client.receive("isProtectiveStopped"))
    with pytest.raises(RuntimeError, match="until 5s after occurrence"):
        client.dashboard("unlockProtectiveStop")
    time.sleep(UNLOCK_DELAY_S)
    client.dashboard("unlockProtectiveStop")
    time.sleep(0.1)
    assert client.receive("isProtectiveStopped") is True


def test_pause_from_the_pendant_and_play(moving, wait_until):
    controller, client = moving()
    client.dashboard("pause")
    wait_until(lambda: client.receive("getRuntimeState") == RuntimeState.PAUSED)
    assert at_rest(controller)
    client.dashboard("play")
    wait_until(lambda: client.receive("getActualTCPPose")[2] == pytest.approx(FAR[2], abs=1e-7))


def test_dashboard_stop_ends_the_motion_for_good(moving, wait_until):
    controller, client = moving()
    client.dashboard("stop")
    wait_until(lambda: client.receive("getRuntimeState") == RuntimeState.STOPPED)
    assert at_rest(controller)
    with pytest.raises(RuntimeError):
        client.dashboard("play")
    assert client.dashboard("running") is False
    assert client.receive("getRobotStatus") == 1  # power alone
    assert client.control("getAsyncOperationProgressEx")["running"] is True  # nobody is left to take it back


def test_stop_during_a_pause_cannot_be_played_again(moving, wait_until):
    _, client = moving()
    client.dashboard("pause")
    client.dashboard("stop")
    wait_until(lambda: client.receive("getRuntimeState") == RuntimeState.STOPPED)
    with pytest.raises(RuntimeError):
        client.dashboard("play")


@pytest.mark.parametrize("fault", [Fault.ROBOT_EMERGENCY_STOP, Fault.SYSTEM_EMERGENCY_STOP])
def test_emergency_stop_ends_the_program_and_cuts_the_power(moving, wait_until, fault):
    controller, client = moving()
    controller.inject(fault)
    wait_until(lambda: client.receive("getRuntimeState") == RuntimeState.STOPPED)
    assert at_rest(controller)
    assert client.receive("isEmergencyStopped") is True
    assert client.receive("getRobotMode") == RobotMode.POWER_OFF
    client.dashboard("brakeRelease")
    controller.clear(fault)
    wait_until(lambda: client.receive("getSafetyMode") == 1)
    time.sleep(0.7)
    assert controller.state().robot_mode is RobotMode.POWER_OFF  # asked for while pressed: not remembered
    client.dashboard("powerOn")
    wait_until(lambda: client.receive("getRobotMode") == RobotMode.IDLE)
    client.dashboard("brakeRelease")
    wait_until(lambda: client.receive("getRobotMode") == RobotMode.RUNNING)
    assert client.control("reuploadScript") is True
    wait_until(lambda: client.control("isProgramRunning"))
    assert at_rest(controller)


def test_safeguard_stop_pauses_and_is_released_with_its_cause(moving, wait_until):
    controller, client = moving()
    controller.inject(Fault.SAFEGUARD_STOP)
    wait_until(lambda: client.receive("getRuntimeState") == RuntimeState.PAUSED)
    assert client.receive("getSafetyStatusBits") == 1 << 4 | 1 << 10
    controller.clear(Fault.SAFEGUARD_STOP)
    wait_until(lambda: client.receive("getSafetyMode") == SafetyMode.NORMAL)
    time.sleep(0.2)
    assert at_rest(controller)


@pytest.mark.parametrize(
    ("fault", "bits"), [(Fault.SAFETY_VIOLATION, 1 << 8 | 1 << 10), (Fault.SAFETY_FAULT, 1 << 9 | 1 << 10)]
)
def test_violation_and_fault_last_until_safety_is_restarted(moving, wait_until, fault, bits):
    controller, client = moving()
    controller.inject(fault)
    wait_until(lambda: client.receive("getSafetyStatusBits") == bits)
    controller.clear()
    time.sleep(0.1)
    assert client.receive("getSafetyStatusBits") == bits
    client.dashboard("restartSafety")
    wait_until(lambda: client.receive("getSafetyStatusBits") == 1)
    assert client.receive("getRobotMode") == RobotMode.POWER_OFF


def test_power_off_from_the_pendant_ends_the_motion(moving, wait_until):
    controller, client = moving()
    controller.power(PowerAction.OFF)
    wait_until(lambda: client.receive("getRuntimeState") == RuntimeState.STOPPED)
    assert at_rest(controller)
    controller.power(PowerAction.ON)
    controller.power(PowerAction.RELEASE_BRAKES)
    wait_until(lambda: controller.state().robot_mode is RobotMode.RUNNING)


def test_release_brings_a_stopped_arm_back_at_once(moving, wait_until):
    controller, client = moving()
    controller.inject(Fault.ROBOT_EMERGENCY_STOP)
    wait_until(lambda: client.receive("getRuntimeState") == RuntimeState.STOPPED)
    controller.release()
    wait_until(lambda: client.receive("getSafetyMode") == 1)
    assert controller.state().robot_mode is RobotMode.RUNNING
    assert at_rest(controller)


def test_watchdog_stops_the_program_when_its_client_dies(start_controller, start_client, wait_until):
    controller = start_controller()
    client = start_client(controller, "control")
    client.control("setWatchdog", 3.0)
    client.control("moveL", FAR, 0.02, 0.5, True)
    killed_s = time.monotonic()
    client.close()
    wait_until(lambda: controller.state().program == "" and at_rest(controller))
    moving_s = max(sample.at_s for sample in controller.samples(killed_s) if sample.tcp_speed_mm_s > 0.0)
    # a third of a second of silence and a tenth of braking, and the delays of a busy machine
    assert moving_s - killed_s < 1.0 / 3.0 + 0.1 + 0.15
    assert controller.state().watchdog_hz == 0.0


def test_watchdog_can_cause_a_protective_stop_instead(start_controller, start_client, wait_until):
    controller = start_controller(watchdog_outcome=WatchdogOutcome.PROTECTIVE_STOP)
    client = start_client(controller, "control")
    client.control("setWatchdog", 3.0)
    client.control("moveL", FAR, 0.02, 0.5, True)
    client.close()
    wait_until(lambda: controller.state().safety_mode is SafetyMode.PROTECTIVE_STOP)
    wait_until(lambda: controller.state().runtime_state is RuntimeState.PAUSED)


def test_fed_watchdog_lets_the_move_arrive(controller, start_client, wait_until):
    client = start_client(controller, "receive", "control")
    client.control("setWatchdog", 3.0)
    client.control("moveL", FAR, 0.05, 0.5, True)
    wait_until(lambda: client.control("kickWatchdog") and client.receive("getActualTCPPose")[2] < FAR[2] + 1e-7)
    assert controller.state().program == "rtde_control"


def test_without_a_watchdog_the_arm_finishes_its_move_when_the_client_dies(controller, start_client, wait_until):
    client = start_client(controller, "control")
    client.control("moveL", FAR, 0.1, 0.5, True)
    client.close()
    wait_until(lambda: abs(controller.state().base_from_flange_nominal[2, 3] - FAR[2] * 1000.0) < 1e-4)


def test_path_through_a_singular_pose_stops_protectively(start_controller, start_client, wait_until):
    controller = start_controller(joints_rad=tuple(np.radians([0, -90, 90, -90, -0.5, 0])))
    client = start_client(controller, "receive", "control")
    x, y, z, *turn = client.receive("getActualTCPPose")
    client.control("moveL", [x, y + 0.1, z, *turn], 0.5, 5.0, True)
    wait_until(lambda: controller.state().safety_mode is SafetyMode.PROTECTIVE_STOP)
