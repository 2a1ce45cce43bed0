"""Service and room as two processes on free loopback ports, the first users, the device files."""

import socket
import time
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from coaxial_client import Coaxial
from simulator.controller import free_loopback_address
from simulator.demo.child import Child, clean_environment, coaxial
from simulator.demo.door_client import Door
from simulator.demo.failure import DemoFailed
from simulator.demo.people import Person, add_person, draw_people
from simulator.demo.telling import Teller
from simulator.devices import DEVICE_FILES

_UP_WITHIN_S = 60.0
_VISION_DEADLINE_S = 60.0  # service and room share one machine here, and its cores with whatever else runs
# Nobody calibrated the room's arm, so that this is what the site knows of it: the accuracy of its nominal kinematics.
# A cart that rolls by less than the two-image check then sees is what the correction is for.
_ARM_SD_MM, _ARM_SD_DEG = 0.5, 0.05
_LOOK_EVERY_S = 0.05


@dataclass(frozen=True, slots=True)
class Stage:
    """What is up, and who may sign in."""

    url: str
    door: Door
    people: Mapping[str, Person]
    folder: Path
    children: tuple[Child, ...]

    def sign_in(self, role: str) -> Coaxial:
        """A client of this person."""
        client, person = Coaxial(self.url), self.people[role]
        client.sign_in(person.name, person.password)
        return client

    def check_alive(self, within_s: float = 0.0) -> None:
        """DemoFailed if a process is gone, or goes in this time."""
        end_s = time.monotonic() + within_s
        while True:
            for child in self.children:
                if child.ended:
                    raise DemoFailed(f"{child.name}_ended", child.last_words())
            if time.monotonic() >= end_s:
                return
            time.sleep(_LOOK_EVERY_S)


@dataclass(frozen=True, slots=True)
class _Plan:
    """Where everything will be."""

    folder: Path
    arm_address: str
    dicom_port: int
    http_port: int
    truth: Path | None

    @property
    def settings(self) -> Path:
        """The service's settings file."""
        return self.folder / "coaxial.toml"

    def write_settings(self) -> None:
        """So that the same service can be started again by hand."""
        lines = (
            f'data_folder = "{self.folder / "service"}"',
            f'arm_address = "{self.arm_address}"',
            "[http]",
            f"port = {self.http_port}",
            "[dicom]",
            f"port = {self.dicom_port}",
            'accepted_callers = ["CARM"]',
            "[vision]",
            f"deadline_s = {_VISION_DEADLINE_S}",
            "[arm_accuracy]",
            f"position_sd_mm = {_ARM_SD_MM}",
            f"rotation_sd_deg = {_ARM_SD_DEG}",
        )
        self.settings.write_text("\n".join(lines) + "\n")


@contextmanager
def open_stage(folder: Path, http_port: int, truth: Path | None, teller: Teller) -> Iterator[Stage]:
    """Everything up; whatever was started is ended with the block. DemoFailed where something does not come up."""
    plan = _Plan(folder, free_loopback_address(), _free_port(), http_port, truth)
    if plan.settings.exists():
        raise DemoFailed(
            "folder_used", f"{folder} has the record of another run, whose secrets are gone: name a new one"
        )
    try:
        (folder / "service").mkdir(parents=True, exist_ok=True)
        plan.write_settings()
    except OSError as error:
        raise DemoFailed("folder_refused", f"{error.filename}: {error.strerror}") from error
    people = draw_people()
    with _room(plan) as room:
        with teller.doing("the first users"):
            for person in people.values():
                add_person(person, plan.settings)
        with _service(plan) as service:
            with teller.doing("service and room come up"):
                url = service.says("Coaxial listens on ", _UP_WITHIN_S)
                door = Door(room.says("Room listens on ", _UP_WITHIN_S))
            stage = Stage(url, door, people, folder, (service, room))
            with closing(door):
                _upload_devices(stage)
                teller.tell(f"service {url}, room {door.url}, arm {plan.arm_address}")
                yield stage


def _room(plan: _Plan) -> Child:
    command = coaxial(
        "simulate", "--port", "0", "--arm-address", plan.arm_address, "--dicom-port", str(plan.dicom_port)
    )
    truth = () if plan.truth is None else ("--truth", str(plan.truth))
    return Child("room", [*command, *truth], plan.folder / "room.log", clean_environment())


def _service(plan: _Plan) -> Child:
    command = coaxial("serve", "--config", str(plan.settings))
    return Child("service", command, plan.folder / "service.log", clean_environment())


def _upload_devices(stage: Stage) -> None:
    with stage.sign_in("engineer") as engineer:
        for kind, file in DEVICE_FILES.items():
            engineer.upload_device(kind, file.read_bytes())


def _free_port() -> int:
    """A port that is free now; the room must know it before the service is up."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
