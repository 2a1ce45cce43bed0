"""Service and controller as processes of their own, and a surgeon's client: only public interfaces are used."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
from argon2 import PasswordHasher

from coaxial_client import Case, Coaxial
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.database.engines import open_database
from simulator.controller import ControllerProcess, ControllerSettings, Payload, free_loopback_address
from tests.databases import Databases
from tests.system.carm import CArm
from tests.system.service_process import PASSWORD, PIN, Service
from tests.system.walk import Walk, lift
from tests.waiting import until

_DEVICES = Path(__file__).parents[1] / "devices"
# The guide straight ahead of the flange, where the controller's installation has it.
_TCP = (
    (_DEVICES / "tcp.toml")
    .read_bytes()
    .replace(b"[20.0, -5.0, 150.0]", b"[0.0, 0.0, 150.0]")
    .replace(b"mass_kg = 0.8", b"mass_kg = 1.0")
    .replace(b"[1.0, 0.0, 60.0]", b"[0.0, 0.0, 50.0]")
)
DEVICES = {
    "guide": (_DEVICES / "guide.toml").read_bytes(),
    "carm": (_DEVICES / "flat-panel.toml").read_bytes(),
    "tcp": _TCP,
    "room": (_DEVICES / "room.toml").read_bytes(),
}
TARGETS = [
    {"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]},
    {"name": "L3 right", "entry_mm": [-30.0, 80.0, 10.0], "target_mm": [-22.0, 40.0, 5.0]},
]
CASE = {"patient_id": "P1", "study_uid": "1.2.3", "position": "prone", "targets": TARGETS}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Whatever drives the whole system keeps its time."""
    for item in items:
        if item.path.is_relative_to(Path(__file__).parent):
            item.add_marker(pytest.mark.real_time)


@pytest.fixture(scope="module")
def controller() -> Iterator[ControllerProcess]:
    """A controller whose installation agrees with the tool file."""
    flange_from_tcp = np.eye(4)
    flange_from_tcp[2, 3] = 150.0
    settings = ControllerSettings(free_loopback_address(), flange_from_tcp=flange_from_tcp, payload=Payload())
    with ControllerProcess(settings) as process:
        yield process


@pytest.fixture(scope="module")
def start_service(tmp_path_factory: pytest.TempPathFactory, databases: Databases) -> Iterator[Callable[..., Service]]:
    """Services on fresh data folders with one user of each role; none is left running."""
    with ExitStack() as stack:

        def start(arm_address: str | None, **more: str) -> Service:
            folder = tmp_path_factory.mktemp("data")
            service = Service(folder, arm_address, stack.enter_context(databases.migrated(folder)), more)
            add_users(service.database_url)
            service.start()
            stack.callback(_end, service)
            return service

        yield start


def _end(service: Service) -> None:
    if service.process.poll() is None:
        service.end()


def add_users(database_url: str) -> None:
    """One of each role, with hashes that cost no time."""
    database = open_database(database_url)
    users = UserStore(database, PasswordHasher(time_cost=1, memory_cost=8, parallelism=1))
    for role in Role:
        users.add(role.value, role, PASSWORD, PIN)
    database.close()


@pytest.fixture(scope="module")
def service(start_service: Callable[..., Service], controller: ControllerProcess) -> Service:
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


@pytest.fixture(name="lift")
def lift_of_case(case: Case) -> Callable[..., dict]:
    """Plans straight up, by so many mm."""
    return lambda mm=40.0: lift(case, mm)


@pytest.fixture
def lead() -> type[Walk]:
    """The way through the procedure, for any case."""
    return Walk


@pytest.fixture
def prepared_case(controller: ControllerProcess) -> Callable[[Coaxial], Case]:
    """Open cases like `case`, with any client; whoever asks ends them."""

    def make(client: Coaxial) -> Case:
        controller.release()
        upload_devices(client)
        return prepare(client.open_case(CASE))

    return make


@pytest.fixture(name="until")
def until_it_comes_to_that() -> Callable[..., None]:
    """Wait for a condition."""
    return until


@pytest.fixture(scope="module")
def carm(service: Service) -> CArm:
    """A C-arm that sends to the service; one, for its clock must go on from case to case."""
    return CArm(service, str(CASE["patient_id"]), str(CASE["study_uid"]))


@pytest.fixture
def walk(case: Case, carm: CArm) -> Walk:
    """The way through the procedure."""
    return Walk(case, carm)


def upload_devices(client: Coaxial) -> None:
    """One file of each kind."""
    for kind, content in DEVICES.items():
        client.upload_device(kind, content)


def prepare(case: Case) -> Case:
    """The arm seen, control taken, the guide stated empty."""
    until(lambda: case.status()["arm"]["base_from_tcp"] is not None)
    case.take_lease("start")
    case.command("guide-state-stated", guide="empty")
    until(lambda: case.status()["arm"]["phase"] == "idle")
    return case
