"""Real components: a database on disk, the whole service behind a real socket; only password hashing is made cheap."""

import asyncio
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import httpx
import numpy as np
import pytest
import uvicorn
from argon2 import PasswordHasher
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, XRayAngiographicImageStorage, generate_uid

from coaxial_client import Coaxial
from service.app import create_app
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.database.engines import Database, open_database
from service.parts import Parts
from service.serving import server_config
from service.settings import DicomSettings, HttpSettings, Settings
from tests.databases import Databases
from tests.service.any_state import Room

PASSWORD, PIN = "correct horse", "2468"
CHEAP_HASHER = PasswordHasher(time_cost=1, memory_cost=8, parallelism=1)


@pytest.fixture
def settings(tmp_path: Path, databases: Databases) -> Iterator[Settings]:
    with databases.empty(tmp_path) as address:
        yield _settings(tmp_path, address)


def _settings(folder: Path, address: str) -> Settings:
    any_port = {"http": HttpSettings(port=0), "dicom": DicomSettings(port=0, accepted_callers=("CARM",))}
    return Settings(data_folder=folder, database_url=address, min_free_bytes=0, **any_port)


@pytest.fixture
def database(tmp_path: Path, databases: Databases) -> Iterator[Database]:
    with databases.migrated(tmp_path) as address:
        database = open_database(address)
        yield database
        database.close()


@pytest.fixture
def users(database: Database) -> UserStore:
    return UserStore(database, CHEAP_HASHER)


@pytest.fixture
def storescu() -> str:
    program = shutil.which("storescu")
    assert program, "missing Debian package: apt-get install dcmtk"
    return program


@dataclass(frozen=True)
class RunningService:
    """The service behind a socket of its own, with one user of each role."""

    url: str
    parts: Parts
    tokens: dict[Role, str]

    def client(self, role: Role | None = Role.SURGEON) -> httpx.Client:
        headers = {"Authorization": f"Bearer {self.tokens[role]}"} if role else {}
        return httpx.Client(base_url=f"{self.url}/api", headers=headers, timeout=20)


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory, databases: Databases) -> Iterator[RunningService]:
    """One service per module of tests; tests in it share its database."""
    folder = tmp_path_factory.mktemp("service")
    with databases.empty(folder) as address:
        yield from serve_in_thread(_settings(folder, address))


@pytest.fixture(scope="module")
def room(running: RunningService, device_files: dict[str, str]) -> Iterator[Room]:
    """Its surgeon at work, in a room whose device files are there."""
    with Coaxial(running.url) as client:
        client.sign_in(Role.SURGEON.value, PASSWORD)
        for kind, content in device_files.items():
            client.upload_device(kind, content.encode())
        yield Room(running, client)


@pytest.fixture(scope="session")
def serving() -> Callable[..., AbstractContextManager[RunningService]]:
    """Services of a test's own settings, one after another."""
    return contextmanager(serve_in_thread)


def serve_in_thread(settings: Settings, claim_reason: str | None = None) -> Iterator[RunningService]:
    """The service of `settings` on a free port, in a thread with an event loop of its own."""
    app = create_app(settings, claim_reason)
    server = uvicorn.Server(server_config(app, settings))

    async def serve() -> None:
        async with app.router.lifespan_context(app):
            await server.serve()

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    try:
        _wait_until_started(server, thread)
        parts: Parts = app.state.parts
        users = UserStore(parts.database, CHEAP_HASHER)
        known = {user.role: user for user in users.list()}
        tokens = {
            role: parts.sessions.create(known.get(role) or users.add(role.value, role, PASSWORD, PIN))[0]
            for role in Role
        }
        port = server.servers[0].sockets[0].getsockname()[1]
        yield RunningService(f"http://127.0.0.1:{port}", parts, tokens)
    finally:
        server.should_exit = True
        thread.join()


def _wait_until_started(server: uvicorn.Server, thread: threading.Thread) -> None:
    give_up = time.monotonic() + 30
    while not server.started:
        assert thread.is_alive(), "the service did not start"
        assert time.monotonic() < give_up
        time.sleep(0.01)


@pytest.fixture
def make_xray() -> Callable[..., bytes]:
    return _xray


def _xray(rows: int = 96, columns: int = 80, seed: int = 0, **elements: object) -> bytes:
    """An XA image; `elements` replace those it would have, None removes one."""
    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.SOPClassUID = XRayAngiographicImageStorage
    dataset.SOPInstanceUID = generate_uid()
    dataset.PatientID, dataset.PatientName, dataset.StudyInstanceUID = "P1", "Doe^Jane", "1.2.3"
    dataset.Modality, dataset.PhotometricInterpretation = "XA", "MONOCHROME2"
    dataset.Rows, dataset.Columns, dataset.SamplesPerPixel, dataset.PixelRepresentation = rows, columns, 1, 0
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = 16, 12, 11
    dataset.PositionerPrimaryAngle, dataset.DistanceSourceToDetector = 10.5, 1000.0
    dataset.PixelData = np.random.default_rng(seed).integers(0, 4000, rows * columns, np.uint16).tobytes()
    for name, value in elements.items():
        if value is None:
            delattr(dataset, name)
        else:
            setattr(dataset, name, value)
    dataset.file_meta.MediaStorageSOPClassUID = dataset.SOPClassUID
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID
    content = BytesIO()
    dataset.save_as(content, enforce_file_format=True)
    return content.getvalue()


@pytest.fixture(scope="session")
def device_files() -> dict[str, str]:
    """A plausible file of each kind."""
    return {"guide": _GUIDE, "carm": _CARM, "tcp": _TCP, "room": _ROOM}


_DEVICES = Path(__file__).parents[1] / "devices"
_GUIDE = (_DEVICES / "guide.toml").read_text()
_CARM = (_DEVICES / "flat-panel.toml").read_text()
_TCP = (_DEVICES / "tcp.toml").read_text().replace("[0.0, 0.0, 0.0]", "[0.0, 0.0, 90.0]")  # a turned guide
_ROOM = (_DEVICES / "room.toml").read_text()
