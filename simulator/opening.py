"""Bringing the whole room up: controller in a process of its own, C-arm and door in this one."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from pydicom.uid import generate_uid

from simulator.carm.dicom import Worklist
from simulator.carm.sending import Destination
from simulator.controller import ControllerProcess, ControllerSettings, Payload
from simulator.devices import read_mounting
from simulator.frames import PARKED_RAD
from simulator.pedal import Pedal
from simulator.planted import arm_truth
from simulator.room import Room
from simulator.truth import Truth


@dataclass(frozen=True, slots=True, eq=False)
class OpenRoom:
    """A room that is up."""

    room: Room
    pedal: Pedal


@contextmanager
def open_room(arm_address: str, destination: Destination, truth: Truth) -> Iterator[OpenRoom]:
    """The room as long as the context lasts; OSError if the arm's address is taken."""
    mounting = read_mounting()
    settings = ControllerSettings(
        address=arm_address,
        joints_rad=PARKED_RAD,
        flange_from_tcp=mounting.flange_from_guide,
        payload=Payload(mounting.mass_kg, mounting.centre_mm),
        truth=arm_truth(truth),
    )
    with ControllerProcess(settings) as controller:
        room = Room(controller, truth)
        worklist = Worklist.of("SIM-0001", "Simulated^Patient", str(generate_uid(prefix=None)))
        yield OpenRoom(room, Pedal(room, destination, worklist))
