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
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, XRayAngiographicImageStorage, generate_uid
from pynetdicom import AE
from scipy.spatial.transform import Rotation

from service.auth.permissions import Role
from service.auth.users import UserStore
from service.client import Case, Coaxial
from service.database.engines import open_database
from service.database.migrate import migrate
from simulator.carm.camera import Camera
from simulator.carm.guide import GuideShape
from simulator.carm.render import render
from simulator.carm.scene import PlacedGuide, Scene
from simulator.controller import ControllerProcess, ControllerSettings, Payload, free_loopback_address

PASSWORD, PIN = "correct horse", "2468"
_COAXIAL = [sys.executable, "-c", "from service.cli.main import main; main()"]
_SECRETS = {"COAXIAL_PASSWORD": PASSWORD, "COAXIAL_PIN": PIN}
_DEVICES = Path(__file__).parents[1] / "devices"
_GUIDE = (_DEVICES / "guide.toml").read_bytes()
_CARM = (_DEVICES / "flat-panel.toml").read_bytes()
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
        return kept | ours | arm | {"COAXIAL_MIN_FREE_BYTES": "0", "COAXIAL_VISION__DEADLINE_S": "90"} | _SECRETS

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


class CArm:
    """Renders a guide at a pose and sends it as a C-arm would, by its own clock."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._exposures = 0
        self.camera = Camera(
            source_to_image_mm=1000.0, pixel_mm=360.0 / 1024, principal_u_px=514.0, principal_v_px=508.0
        )

    def expose(self, source_from_guide: np.ndarray, **elements: object) -> int:
        """Send an image of the guide; the status of the C-STORE. `elements` replace those of the data set."""
        return self.send(self.image(source_from_guide, **elements))

    def image(self, source_from_guide: np.ndarray, **elements: object) -> Dataset:
        """An XA image; each is a second later than the one before."""
        acquired = self.next_time()
        guides = (PlacedGuide(GuideShape(), source_from_guide),)
        scene = Scene(self.camera, guides, (500.0, 500.0), intensifier=False)
        pixels = render(scene, seed=self._exposures).pixels
        return _xa(pixels, **{"AcquisitionTime": acquired, **elements})

    def next_time(self) -> str:
        """The C-arm's own clock, a second later than the last time."""
        self._exposures += 1
        return f"12{self._exposures // 60:02d}{self._exposures % 60:02d}.0"

    def send(self, dataset: Dataset) -> int:
        """C-STORE."""
        entity = AE(ae_title="CARM")
        entity.add_requested_context(XRayAngiographicImageStorage, ExplicitVRLittleEndian)
        with self._service.sign_in() as client:
            port = client.status()["dicom_port"]
        association = entity.associate("127.0.0.1", port, ae_title="COAXIAL")
        status = association.send_c_store(dataset)
        association.release()
        return int(status.Status)


def _xa(pixels: np.ndarray, **elements: object) -> Dataset:
    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.SOPClassUID = XRayAngiographicImageStorage
    dataset.SOPInstanceUID = generate_uid()
    dataset.PatientID, dataset.PatientName, dataset.StudyInstanceUID = "P1", "Doe^Jane", "1.2.3"
    dataset.Modality, dataset.PhotometricInterpretation = "XA", "MONOCHROME2"
    dataset.StationName, dataset.AcquisitionDate = "CARM", "20260105"
    dataset.Rows, dataset.Columns = pixels.shape
    dataset.SamplesPerPixel, dataset.PixelRepresentation = 1, 0
    bits = 8 * pixels.dtype.itemsize
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = bits, bits, bits - 1
    dataset.PixelData = pixels.tobytes()
    for name, value in elements.items():
        setattr(dataset, name, value)
    dataset.file_meta.MediaStorageSOPClassUID = dataset.SOPClassUID
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID
    return dataset


def tilted_guide() -> np.ndarray:
    """source_from_guide of a guide 750 mm from the source, tilted by 8 deg: a plain view of it."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xy", [8.0, -3.0], degrees=True).as_matrix()
    pose[:3, 3] = [10.0, -5.0, 750.0]
    return pose


class Held(Exception):  # noqa: N818  a turn of the procedure, no error of the tests
    """The case went into safe_hold on its way."""


class Walk:
    """Leads a case from state to state, the C-arm seeing the guide where the motions bring it."""

    def __init__(self, case: Case, carm: CArm) -> None:
        self.case = case
        self.carm = carm
        self.source_from_guide = tilted_guide()
        self.target_px = (560.0, 470.0)

    def to(self, state: str) -> dict:
        """From case_open to a state of the plain way, off_target and safe_hold included; its status.

        A crowded machine may lose the feedback or the hold for a moment, which holds the case: the way is gone anew.
        """
        for _ in range(4):
            try:
                self._go(state)
                return self.case.wait_for(state)
            except Held:
                until(lambda: self.case.status()["arm"]["connected"])
                self.case.command("acknowledged", guide="empty")
                self.case.command("patient-moved", what="nothing: the way is gone anew")
        pytest.fail("the machine is too busy for a procedure")

    def _go(self, state: str) -> None:
        way = ["carm_positioned", "registered", "target_chosen", "moved", "verified", "inserting", "sleeve_inserted"]
        beside = {"off_target": "moved", "safe_hold": "carm_positioned", "image_acquired": "carm_positioned"}
        goal = beside.get(state, state)
        for step in way[: way.index(goal) + 1] if goal in way else []:
            getattr(self, step)()
        if state == "off_target":
            self.off_target()
        if state == "image_acquired":
            self.case.command("exposure-requested")
            self.carm.expose(self.source_from_guide)
        if state == "safe_hold":
            self.case.stop()

    def _comes(self, state: str) -> None:
        until(lambda: self.case.status()["state"] in (state, "safe_hold"), 90.0)
        if self.case.status()["state"] == "safe_hold":
            raise Held(self.case.status()["held_for"])

    def carm_positioned(self) -> None:
        self.case.command("carm-position-confirmed")

    def registered(self) -> None:
        self.case.command("exposure-requested")
        self.carm.expose(self.source_from_guide)
        self._comes("registered")

    def target_chosen(self, planned_target: str | None = "L3 left") -> None:
        echo = self.case.echo(self.case.status()["chain"]["image"], self.target_px)
        answer = self.case.command("target-confirmed", echo_id=echo["echo_id"], planned_target=planned_target)
        self._aim(answer)

    def moved(self, kind: str = "targeting") -> None:
        plan = self.case.plan(kind)
        with self.case.hold(self.case.approve(plan, PIN)) as hold:
            cause = hold.wait(60.0).cause
        if cause in ("heartbeat_lost", "feedback_lost"):
            raise Held(cause)
        assert cause == "arrived"

    def verified(self) -> None:
        self._verify(self.aimed)
        self._comes("verified")

    def off_target(self) -> None:
        self._verify(self.aimed @ _shifted(3.0))
        self._comes("off_target")

    def corrected(self) -> None:
        self._aim(self.case.command("correction-requested"))
        self.moved("corrective")

    def inserting(self) -> None:
        self.case.command("insertion-started", pin=PIN)

    def sleeve_inserted(self) -> None:
        self.case.command("sleeve-in")

    def _verify(self, source_from_guide: np.ndarray) -> None:
        self.case.command("exposure-requested")
        self.source_from_guide = source_from_guide
        self.carm.expose(source_from_guide)

    def _aim(self, answer: dict) -> None:
        self.aimed = self.source_from_guide @ np.array(answer["detail"]["targeting"]["guide_from_goal"])


def _shifted(mm: float) -> np.ndarray:
    shift = np.eye(4)
    shift[0, 3] = mm
    return shift


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


@pytest.fixture(name="lift")
def lift_of_case(case: Case) -> Callable[..., dict]:
    """Plans straight up, by so many mm."""
    return lambda mm=40.0: lift(case, mm)


@pytest.fixture
def lift_of() -> Callable[[Case, float], dict]:
    """Plans straight up for any case."""
    return lift


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
    return CArm(service)


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
    until(lambda: case.status()["arm"]["connected"])
    case.take_lease("start")
    case.command("guide-state-stated", guide="empty")
    until(lambda: case.status()["arm"]["phase"] == "idle")
    return case


def lift(case: Case, mm: float = 40.0) -> dict:
    """A plan straight up from where the arm is."""
    pose = np.array(case.status()["arm"]["base_from_tcp"])
    vector_deg = np.rad2deg(Rotation.from_matrix(pose[:3, :3]).as_rotvec())
    goal = {"translation_mm": list(pose[:3, 3] + [0.0, 0.0, mm]), "rotation_vector_deg": list(vector_deg)}
    return case.plan("approach", base_from_goal=goal)


def until(condition: Callable[[], object], within_s: float = 20.0) -> None:
    """Wait for a condition."""
    end_s = time.monotonic() + within_s
    while not condition():
        assert time.monotonic() < end_s, "it did not come to that"
        time.sleep(0.02)
