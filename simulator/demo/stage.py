"""Service and room as two processes on free loopback ports, the first users, the device files."""

import json
import shutil
import socket
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from coaxial_client import Coaxial
from simulator.controller import free_loopback_address
from simulator.demo.child import Child, clean_environment, coaxial
from simulator.demo.door_client import Door
from simulator.demo.failure import DemoFailed, NothingStartedError
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

    @property
    def record(self) -> Path:
        """The service's data folder."""
        return self.folder / "service"

    def begin(self) -> None:
        """Make the folders, and the settings, so that the same service can be started again by hand."""
        try:
            self._make_folders()
        except OSError as error:
            raise NothingStartedError("folder_refused", f"{error.filename}: {error.strerror}") from error
        try:
            self.settings.write_text(self._settings_text(), encoding="utf-8")
        except OSError as error:
            self.take_back()
            raise NothingStartedError("folder_refused", f"{self.settings}: {error.strerror}") from error

    def _make_folders(self) -> None:
        if self.settings.exists() or self.record.exists():
            raise NothingStartedError(
                "folder_used", f"{self.folder} has the record of another run, whose secrets are gone: name a new one"
            )
        self.record.mkdir(parents=True)  # of two runs at once one is refused

    def take_back(self) -> None:
        """Leave nothing but the logs of what this run made: nobody ever signed in, and the next may have the folder."""
        shutil.rmtree(self.record, ignore_errors=True)
        self.settings.unlink(missing_ok=True)

    def _settings_text(self) -> str:
        lines = (
            f"data_folder = {json.dumps(str(self.record), ensure_ascii=False)}",
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
        return "\n".join(lines) + "\n"


@contextmanager
def open_stage(folder: Path, http_port: int, truth: Path | None, teller: Teller) -> Iterator[Stage]:
    """Everything up; whatever was started is ended with the block. DemoFailed where something does not come up."""
    plan = _Plan(folder, free_loopback_address(), _free_port(), http_port, truth)
    plan.begin()
    with ExitStack() as parts:
        try:
            stage = _start(plan, teller, parts)
        except BaseException:  # an interruption too
            parts.close()
            plan.take_back()
            raise
        yield stage


def _start(plan: _Plan, teller: Teller, parts: ExitStack) -> Stage:
    people = draw_people()
    room = parts.enter_context(_room(plan))
    with teller.doing("the first users"):
        for person in people.values():
            add_person(person, plan.settings)
    service = parts.enter_context(_service(plan))
    with teller.doing("service and room come up"):
        url = service.says("Coaxial listens on ", _UP_WITHIN_S)
        door = parts.enter_context(closing(Door(room.says("Room listens on ", _UP_WITHIN_S))))
    stage = Stage(url, door, people, plan.folder, (service, room))
    _upload_devices(stage)
    teller.tell(f"service {url}, room {door.url}, arm {plan.arm_address}")
    return stage


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
