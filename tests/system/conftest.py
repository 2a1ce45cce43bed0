"""The service and a controller as separate processes, and a surgeon's client: only public interfaces are used."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from argon2 import PasswordHasher

from service.auth.permissions import Role
from service.auth.users import UserStore
from service.client import Case, Coaxial
from service.database.engines import open_database
from service.database.migrate import migrate
from simulator.controller import ControllerProcess, ControllerSettings, Payload, free_loopback_address

PASSWORD, PIN = "correct horse", "2468"
_COAXIAL = [sys.executable, "-c", "from service.cli.main import main; main()"]
_SECRETS = {"COAXIAL_PASSWORD": PASSWORD, "COAXIAL_PIN": PIN}
_GUIDE = b"""
name = "reference-guide"
version = 1
[small_ring]
radius = 20.0
[big_ring]
radius = 30.0
[axis]
separation = 60.0
[indicator_line]
start = 26.0
end = 66.0
[wire]
diameter = 1.2
[bead]
position = [0.0, 45.0, -30.0]
diameter = 3.0
[tolerance]
radius_sd = 0.02
separation_sd = 0.03
bead_sd = 0.05
bore_concentricity_sd = 0.02
"""
_CARM = b"""
name = "reference-intensifier"
version = 1
[geometry]
source_to_image_distance = 1000.0
source_to_image_distance_sd = 30.0
principal_point_sd_px = 15.0
[detector]
kind = "image-intensifier"
field_of_view = 360.0
[plate]
ball_spacing = 15.0
ball_diameter = 2.0
"""
_TCP = b"""
name = "guide-on-flange"
version = "1"
[tcp]
translation_mm = [0.0, 0.0, 150.0]
rotation_vector_deg = [0.0, 0.0, 0.0]
[payload]
mass_kg = 1.0
centre_mm = [0.0, 0.0, 50.0]
"""
DEVICES = {"guide": _GUIDE, "carm": _CARM, "tcp": _TCP}
TARGETS = [
    {"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]},
    {"name": "L3 right", "entry_mm": [-30.0, 80.0, 10.0], "target_mm": [-22.0, 40.0, 5.0]},
]
CASE = {"patient_id": "P1", "study_uid": "1.2.3", "position": "prone", "targets": TARGETS}


@dataclass
class Service:
    """`coaxial serve` on a data folder that outlives it."""

    folder: Path
    arm_address: str | None
    process: "subprocess.Popen[str]" = field(init=False)
    url: str = field(init=False)

    def start(self) -> None:
        """Start, and wait for the address."""
        environment = self.environment()
        with (self.folder / "log").open("a") as log:
            self.process = subprocess.Popen(
                [*_COAXIAL, "serve"], env=environment, stdout=subprocess.PIPE, stderr=log, text=True
            )
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().removeprefix("Coaxial listens on ").strip()
        assert self.url, (self.folder / "log").read_text()

    def kill(self) -> None:
        """As a power switch would."""
        self.process.send_signal(signal.SIGKILL)
        self._wait(10)

    def end(self) -> None:
        """As an operator would."""
        self.process.terminate()
        self._wait(20)

    def _wait(self, timeout_s: float) -> None:
        self.process.wait(timeout_s)
        assert self.process.stdout is not None
        self.process.stdout.close()

    def environment(self) -> dict[str, str]:
        """Free ports; nothing of the caller's own settings."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith("COAXIAL_")}
        ours = {"COAXIAL_DATA_FOLDER": str(self.folder), "COAXIAL_HTTP__PORT": "0", "COAXIAL_DICOM__PORT": "0"}
        arm = {} if self.arm_address is None else {"COAXIAL_ARM_ADDRESS": self.arm_address}
        return kept | ours | arm | {"COAXIAL_MIN_FREE_BYTES": "0"} | _SECRETS

    def run(self, *arguments: str) -> "subprocess.CompletedProcess[str]":
        """Another `coaxial` command on the same folder."""
        return subprocess.run(
            [*_COAXIAL, *arguments], env=self.environment(), capture_output=True, text=True, timeout=60
        )

    def log(self) -> str:
        """What the service said."""
        return (self.folder / "log").read_text()

    def sign_in(self, name: str = "surgeon") -> Coaxial:
        """A client of this user."""
        client = Coaxial(self.url)
        client.sign_in(name, PASSWORD)
        return client


@pytest.fixture(scope="module")
def controller() -> Iterator[ControllerProcess]:
    """A controller whose installation agrees with the tool file."""
    flange_from_tcp = np.eye(4)
    flange_from_tcp[2, 3] = 150.0
    settings = ControllerSettings(free_loopback_address(), flange_from_tcp=flange_from_tcp, payload=Payload())
    with ControllerProcess(settings) as process:
        yield process


@pytest.fixture(scope="module")
def start_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[str | None], Service]]:
    """Services on fresh data folders with one user of each role; none is left running."""
    started: list[Service] = []

    def start(arm_address: str | None) -> Service:
        service = Service(tmp_path_factory.mktemp("data"), arm_address)
        started.append(service)
        _add_users(service.folder)
        service.start()
        return service

    yield start
    for service in started:
        if service.process.poll() is None:
            service.end()


def _add_users(folder: Path) -> None:
    """One of each role, with hashes that cost no time."""
    database = open_database(f"sqlite:///{folder / 'coaxial.sqlite'}")
    migrate(database)
    users = UserStore(database, PasswordHasher(time_cost=1, memory_cost=8, parallelism=1))
    for role in Role:
        users.add(role.value, role, PASSWORD, PIN)
    database.close()


@pytest.fixture(scope="module")
def service(start_service: Callable[[str | None], Service], controller: ControllerProcess) -> Service:
    """A service with an arm."""
    return start_service(controller.address)


@pytest.fixture(scope="module")
def room(service: Service) -> Iterator[Coaxial]:
    """A surgeon, signed in; the device files are uploaded."""
    with service.sign_in() as client:
        upload_devices(client)
        yield client


@pytest.fixture
def case(room: Coaxial, controller: ControllerProcess) -> Iterator[Case]:
    """An open case with control taken and the guide stated empty over a calm arm; aborted at the end."""
    controller.release()
    opened = room.open_case(CASE)
    yield prepare(opened)
    opened.command("case-aborted", reason="end of the test")


def upload_devices(client: Coaxial) -> None:
    """One file of each kind."""
    for kind, content in DEVICES.items():
        client.upload_device(kind, content)


def prepare(case: Case) -> Case:
    """The arm seen, control taken, the guide stated empty."""
    until(lambda: case.status()["arm"]["connected"])
    case.take_lease("start")
    case.command("guide-state-stated", guide="empty")
    until(lambda: case.status()["arm"]["phase"] == "idle")
    return case


def until(condition: Callable[[], object], within_s: float = 20.0) -> None:
    """Wait for a condition."""
    end_s = time.monotonic() + within_s
    while not condition():
        assert time.monotonic() < end_s, "it did not come to that"
        time.sleep(0.02)
