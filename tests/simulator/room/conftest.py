"""A room whose arm is wherever a test puts it: to take a picture it needs nothing else of a controller."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from pydicom.dataset import Dataset
from pydicom.uid import XRayAngiographicImageStorage
from pynetdicom import AE, evt

from simulator.by_eye import guide_in_beam
from simulator.carm.dicom import Worklist
from simulator.carm.sending import Destination
from simulator.controller import ControllerState, Fault, Payload, RobotMode, RuntimeState, SafetyMode
from simulator.frames import PARKED_RAD, ROOM_FROM_BASE, displacement, inverse
from simulator.kinematics import NOMINAL_UR5, base_from_flange
from simulator.pedal import Pedal
from simulator.room import Room
from simulator.truth import read_truth


class StillArm:
    """Stands in for a controller where no wire is under test."""

    address = "127.0.0.2"

    def __init__(self) -> None:
        joints = np.array(PARKED_RAD)
        flange = base_from_flange(NOMINAL_UR5, joints)
        self._state = ControllerState(
            at_s=0.0,
            controller_time_s=0.0,
            joints_rad=joints,
            joint_speeds_rad_s=np.zeros(6),
            base_from_flange_nominal=flange,
            flange_from_tcp=np.eye(4),
            true_joints_rad=joints,
            base_from_flange_true=flange,
            tcp_speed_mm_s=0.0,
            payload=Payload(),
            robot_mode=RobotMode.RUNNING,
            safety_mode=SafetyMode.NORMAL,
            runtime_state=RuntimeState.STOPPED,
            program="",
            moving=False,
            watchdog_hz=0.0,
            speed_scaling=1.0,
            faults=frozenset(),
            cycles=0,
            latest_cycle_late_s=0.0,
            stalled_s=0.0,
        )

    def state(self) -> ControllerState:
        return self._state

    def put(self, base_from_flange_true: np.ndarray, joints_rad: np.ndarray | None = None) -> None:
        joints = self._state.joints_rad if joints_rad is None else joints_rad
        self._state = replace(self._state, base_from_flange_true=base_from_flange_true, joints_rad=joints)

    def inject(self, fault: Fault) -> None:
        self._state = replace(self._state, faults=self._state.faults | {fault})

    def clear(self, fault: Fault | None = None) -> None:
        self._state = replace(self._state, faults=self._state.faults - {fault} if fault else frozenset())


class Receiver:
    """A DICOM store that keeps what it got."""

    def __init__(self) -> None:
        self.images: list[Dataset] = []
        entity = AE(ae_title="STORE")
        entity.add_supported_context(XRayAngiographicImageStorage)
        self._server = entity.start_server(("127.0.0.1", 0), block=False, evt_handlers=[(evt.EVT_C_STORE, self._keep)])
        self.destination = Destination("127.0.0.1", self._server.server_address[1], "STORE")

    def _keep(self, event: evt.Event) -> int:
        self.images.append(event.dataset)
        return 0x0000

    def close(self) -> None:
        self._server.shutdown()


@pytest.fixture
def arm() -> StillArm:
    return StillArm()


@pytest.fixture
def room(arm: StillArm) -> Room:
    """At a breath that displaces nothing."""
    return Room(arm, read_truth(), now_s=lambda: 0.0)


@pytest.fixture
def aligned(room: Room, arm: StillArm) -> Callable[..., None]:
    """Puts the guide exactly into the beam through a pedicle, shifted and turned there as asked (guide frame)."""

    def align(name: str, shift_mm: tuple = (0.0, 0.0, 0.0), turn_rad: tuple = (0.0, 0.0, 0.0)) -> None:
        target = (room.patient.room_from_patient @ [*room.pedicle(name).target_in_patient, 1.0])[:3]
        exact = guide_in_beam(room.stand.room_from_source()[:3, 3], target)
        wanted = exact @ displacement(np.array(shift_mm), np.array(turn_rad))
        arm.put(inverse(ROOM_FROM_BASE) @ wanted @ inverse(room.planted.flange_from_guide))

    return align


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    running = Receiver()
    yield running
    running.close()


@pytest.fixture
def pedal(room: Room, receiver: Receiver) -> Pedal:
    return Pedal(room, receiver.destination, Worklist.of("P1", "Some^One", "1.2.3"))
