"""An arm of numbers for the pure parts; a controller and a guard for the rest."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from robot.arm import ArmState
from robot.guard.client import GuardConfig
from robot.guard.journal import Journal
from robot.guard.messages import BeginMove
from robot.kinematics import base_from_flange, solve_joints
from robot.safety import SafetyState
from simulator.controller import ControllerProcess, ControllerSettings, free_loopback_address
from tests.robot.bench import Bench
from tests.robot.guarded_arm import Room

PARKED_RAD = np.deg2rad([0.0, -90.0, 90.0, -90.0, -90.0, 0.0])


@pytest.fixture
def reading() -> ArmState:
    """The parked arm at rest, at time 0 of both clocks."""
    return ArmState(
        controller_time_s=0.0,
        received_at_s=0.0,
        joints_rad=PARKED_RAD.copy(),
        joint_speeds_rad_s=np.zeros(6),
        base_from_tcp=base_from_flange(PARKED_RAD),
        tcp_speed_mm_s=0.0,
        tcp_turn_speed_rad_s=0.0,
        tcp_force_n=np.zeros(3),
        payload_kg=1.0,
        payload_centre_mm=np.array([0.0, 0.0, 50.0]),
        safety_bits=1,
        robot_status_bits=1,
        robot_mode=7,
        runtime_state=1,
        program_running=False,
        safety=SafetyState.NORMAL,
    )


@pytest.fixture
def room(reading: ArmState, tmp_path: Path) -> Iterator[Room]:
    """A guard over that arm, in numbers alone, acknowledged."""
    journal = Journal(tmp_path)
    yield Room(reading, journal)
    journal.close()


@cache
def displaced_arm(x_mm: float, y_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Pose and joints of the parked arm with its TCP displaced."""
    pose = base_from_flange(PARKED_RAD)
    pose[:2, 3] += x_mm, y_mm
    joints_rad = solve_joints(pose, PARKED_RAD)
    assert joints_rad is not None
    return pose, joints_rad


@pytest.fixture
def at(reading: ArmState) -> Callable[..., ArmState]:
    """A reading at a time, the TCP displaced along base x and y and moving at a speed."""

    def make(
        time_s: float, x_mm: float = 0.0, speed_mm_s: float = 0.0, y_mm: float = 0.0, **changes: object
    ) -> ArmState:
        pose, joints = displaced_arm(x_mm, y_mm)
        moved = replace(reading, controller_time_s=time_s, received_at_s=time_s, tcp_speed_mm_s=speed_mm_s)
        return replace(moved, base_from_tcp=pose, joints_rad=joints, **{"program_running": True, **changes})

    return make


@pytest.fixture
def move(reading: ArmState) -> BeginMove:
    """Ten millimetres along base x."""
    goal = reading.base_from_tcp.copy()
    goal[0, 3] += 10.0
    return BeginMove(
        permit_id="permit-1",
        base_from_goal=goal,
        start_joints_rad=reading.joints_rad,
        speed_mm_s=20.0,
        acceleration_mm_s2=50.0,
        duration_s=0.9,
        flange_from_guide=np.eye(4),
        payload_kg=1.0,
        payload_centre_mm=np.array([0.0, 0.0, 50.0]),
        tcp_tolerance_mm=0.05,
        tcp_tolerance_rad=3e-4,
        payload_tolerance_kg=0.05,
        payload_tolerance_mm=5.0,
    )


@pytest.fixture(scope="module")
def started_controller() -> Iterator[ControllerProcess]:
    with ControllerProcess(ControllerSettings(address=free_loopback_address())) as process:
        yield process


@pytest.fixture
def controller(started_controller: ControllerProcess) -> ControllerProcess:
    """A controller as it was set up, whatever the tests before did to it."""
    settings = started_controller.settings
    started_controller.release()
    started_controller.set_speed_scaling(1.0)
    started_controller.set_tcp(settings.flange_from_tcp)
    started_controller.set_payload(settings.payload)
    started_controller.teleport(np.array(settings.joints_rad))
    return started_controller


@pytest.fixture
def bench(controller: ControllerProcess, tmp_path: Path) -> Iterator[Bench]:
    """A guard that is idle over a running controller; nothing is left behind."""
    bench = Bench(GuardConfig(controller.address, tmp_path / "journal"), controller)
    bench.start()
    yield bench
    bench.close()
    assert bench.client.process_id is None


@pytest.fixture
def make_bench() -> Iterator[Callable[..., Bench]]:
    """Benches over any address, their guards not started."""
    made: list[Bench] = []

    def make(address: str, journal_folder: Path, **changes: float) -> Bench:
        made.append(Bench(GuardConfig(address, journal_folder, **changes)))
        return made[-1]

    yield make
    for bench in made:
        bench.close()
