"""Real components: SQLite on disk, the whole service behind a real socket; only password hashing is made cheap."""

import shutil
import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
import uvicorn
from argon2 import PasswordHasher

from service.app import create_app
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.database.engines import Database, open_database
from service.database.migrate import migrate
from service.parts import Parts
from service.settings import DicomSettings, HttpSettings, Settings

PASSWORD, PIN = "correct horse", "2468"
CHEAP_HASHER = PasswordHasher(time_cost=1, memory_cost=8, parallelism=1)


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(data_folder=tmp_path, min_free_bytes=0, http=HttpSettings(port=0), dicom=DicomSettings(port=0))


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    database = open_database(f"sqlite:///{tmp_path / 'coaxial.sqlite'}")
    migrate(database)
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
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningService]:
    """One service per module of tests; tests in it share its database."""
    folder = tmp_path_factory.mktemp("service")
    settings = Settings(data_folder=folder, min_free_bytes=0, http=HttpSettings(port=0), dicom=DicomSettings(port=0))
    yield from serve_in_thread(settings)


def serve_in_thread(settings: Settings) -> Iterator[RunningService]:
    app = create_app(settings)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        server = uvicorn.Server(uvicorn.Config(app, log_config=None, timeout_graceful_shutdown=1))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            _wait_until_started(server, thread)
            parts: Parts = app.state.parts
            users = UserStore(parts.database, CHEAP_HASHER)
            tokens = {role: parts.sessions.create(users.add(role.value, role, PASSWORD, PIN))[0] for role in Role}
            yield RunningService(f"http://127.0.0.1:{listener.getsockname()[1]}", parts, tokens)
        finally:
            server.should_exit = True
            thread.join()


def _wait_until_started(server: uvicorn.Server, thread: threading.Thread) -> None:
    give_up = time.monotonic() + 30
    while not server.started:
        assert thread.is_alive(), "the service did not start"
        assert time.monotonic() < give_up
        time.sleep(0.01)
