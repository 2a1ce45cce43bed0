"""`coaxial serve` and `coaxial user` as processes: started, refused, killed, started again."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from service.auth.permissions import Role
from tests.waiting import until

_COAXIAL = [sys.executable, "-c", "from service.cli.main import main; main()"]
_TELLS_WHAT_IS_SPARED = "import atexit, gc; atexit.register(lambda: print(gc.get_freeze_count()))\n"
_ADDRESS = "COAXIAL_DATABASE_URL"
_SECRETS = {"COAXIAL_PASSWORD": "correct horse", "COAXIAL_PIN": "2468"}


def _environment(folder: Path, **more: str) -> dict[str, str]:
    """Free ports; nothing of the caller's own settings."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("COAXIAL_") or name == _ADDRESS}
    ours = {"COAXIAL_DATA_FOLDER": str(folder), "COAXIAL_HTTP__PORT": "0", "COAXIAL_MIN_FREE_BYTES": "0"}
    return kept | ours | {"COAXIAL_DICOM__PORT": "0", "COAXIAL_DICOM__ACCEPTED_CALLERS": '["STORESCU"]'} | more


def _coaxial(folder: Path, *arguments: str, stdin: str = "", **more: str) -> subprocess.CompletedProcess:
    command = [*_COAXIAL, *arguments]
    environment = _environment(folder, **more)
    return subprocess.run(command, env=environment, input=stdin, capture_output=True, text=True, timeout=60)


@contextmanager
def _serving(folder: Path, before: str = "", **more: str) -> Iterator[tuple[subprocess.Popen, str]]:
    """A service, its address, and in its interpreter some code that runs before it."""
    environment, [*python, code] = _environment(folder, **more), _COAXIAL
    with subprocess.Popen(
        [*python, before + code, "serve"], env=environment, stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process, process.stdout.readline().removeprefix("Coaxial listens on ").strip()
        finally:
            process.kill()


def _sign_in(url: str) -> httpx.Client:
    answer = httpx.post(f"{url}/api/session", json={"name": "anna", "password": "correct horse"}, timeout=20)
    headers = {"Authorization": f"Bearer {answer.json()['token']}"}
    return httpx.Client(base_url=f"{url}/api", headers=headers, timeout=20)


@pytest.fixture
def empty_folder(tmp_path, databases, monkeypatch):
    """A data folder whose database has no schema yet."""
    with databases.empty(tmp_path) as address:
        monkeypatch.setenv(_ADDRESS, address)
        yield tmp_path


@pytest.fixture
def folder(tmp_path, database, users, monkeypatch):
    """A data folder with a first user."""
    users.add("anna", Role.SURGEON, "correct horse", "2468")
    monkeypatch.setenv(_ADDRESS, str(database.writer.url))
    return tmp_path


@pytest.mark.hazard("H32")
def test_a_service_tells_its_address_keeps_its_room_obeys_and_ends_at_a_signal(folder):
    """H32: nothing that it loaded is searched for garbage while it serves, which would hold a stop up."""
    with _serving(folder, _TELLS_WHAT_IS_SPARED) as (process, url):
        _is_refused_as_a_second_one(_coaxial(folder, "serve"), process)
        until(lambda: httpx.get(f"{url}/api/health/ready").status_code == 200)
        with _sign_in(url) as client:
            assert client.get("/status").json()["room"] == "room-1"
            assert _coaxial(folder, "user", "disable", "anna").returncode == 0
            assert client.get("/status").json()["code"] == "not_signed_in"
        process.terminate()
        assert process.wait(10) == 0
        assert int(process.stdout.read()) > 100_000


def _is_refused_as_a_second_one(second: subprocess.CompletedProcess, first: subprocess.Popen) -> None:
    assert second.returncode == 3
    assert second.stderr.splitlines()[-1].startswith("room_claimed: ")
    assert str(first.pid) in second.stderr


def test_the_image_worker_is_up_before_there_is_an_image(folder):
    """The first image would pay for its imports with two seconds, while the surgeon waits."""
    with _serving(folder) as (process, url):
        until(lambda: _image_workers(process.pid))
        until(lambda: httpx.get(f"{url}/api/health/ready").status_code == 200)
        assert _image_workers(process.pid) == 1


def test_a_service_whose_image_worker_does_not_start_says_so_and_goes_on(folder):
    with _serving(folder, COAXIAL_VISION__START_DEADLINE_S="0.05") as (process, url):
        until(lambda: httpx.get(f"{url}/api/health/ready").json().get("measured") == "vision_deadline")
        assert httpx.get(f"{url}/api/health/live").status_code == 200
        process.terminate()
        assert process.wait(10) == 0


def _image_workers(service_pid: int) -> int:
    """How many processes the service has that are spawned for image work."""
    threads = (Path("/proc") / str(service_pid) / "task").iterdir()
    children = {child for thread in threads for child in (thread / "children").read_text().split()}
    return sum(b"spawn_main" in (Path("/proc") / child / "cmdline").read_bytes() for child in children)


def test_after_a_kill_the_next_service_starts_at_once_with_sessions_and_records(folder):
    with _serving(folder) as (process, url):
        client = _sign_in(url)
        process.send_signal(signal.SIGKILL)
        process.wait()
    with _serving(folder) as (process, url):
        client.base_url = f"{url}/api"
        actions = [entry["action"] for entry in client.get("/audit").json()]
        client.close()
    assert actions == ["ledger_begun", "user_added", "signed_in", "log_read"]


@pytest.mark.hazard("H25")
def test_no_image_that_was_answered_with_success_is_lost_by_a_kill(folder, storescu, make_xray, tmp_path):
    file = tmp_path / "image.dcm"
    file.write_bytes(make_xray(rows=512, columns=512))
    answered = 0
    with _serving(folder) as (process, url):
        with _sign_in(url) as client:
            port = client.get("/status").json()["dicom_port"]
        threading.Timer(1.5, process.kill).start()
        command = [storescu, "--invent-instance", "127.0.0.1", str(port), str(file)]
        while subprocess.run(command, capture_output=True, timeout=60).returncode == 0:
            answered += 1
    assert answered > 0
    with _serving(folder) as (process, url), _sign_in(url) as client:
        images = client.get("/images").json()
        assert len(images) in (answered, answered + 1), "one may be committed and not yet answered"
        assert len(client.get(f"/images/{images[0]['id']}/original").content) > 512 * 512 * 2


@pytest.mark.parametrize(
    ("setting", "code"),
    [
        ({"COAXIAL_MIN_FREE_BYTES": "99999999999999999"}, "disk_full"),
        ({"COAXIAL_DATABASE_URL": "sqlite:////proc/none/x.sqlite"}, "database_fault"),
        ({"COAXIAL_DICOM__HOST": "203.0.113.1"}, "settings_refused"),
        ({"COAXIAL_DATA_FOLDER": __file__}, "settings_refused"),
    ],
)
def test_what_cannot_start_says_why_in_one_line(tmp_path, setting, code):
    refused = _coaxial(tmp_path, "serve", **setting)
    assert refused.returncode == 3
    assert refused.stderr.splitlines()[-1].startswith(f"{code}: ")
    assert "Traceback" not in refused.stderr


def test_a_taken_http_port_ends_the_service_and_frees_the_room(folder):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        refused = _coaxial(folder, "serve", "--port", str(taken.getsockname()[1]))
        assert refused.returncode == 3
        assert "address already in use" in refused.stderr
        assert refused.stderr.splitlines()[-1].startswith("settings_refused: cannot listen for HTTP")
    with _serving(folder) as (_, url):
        assert url.startswith("http://127.0.0.1:")


def test_the_first_user_makes_the_database_and_can_sign_in(empty_folder):
    added = _coaxial(empty_folder, "user", "add", "anna", "--role", "surgeon", **_SECRETS)
    assert (added.returncode, added.stdout) == (0, "added anna as surgeon\n"), added.stderr
    with _serving(empty_folder) as (_, url), _sign_in(url) as client:
        assert client.get("/session").json()["role"] == "surgeon"


def test_users_are_added_from_stdin_and_listed(folder):
    added = _coaxial(folder, "user", "add", "ben", "--role", "operator", stdin="long enough\n1234\n")
    assert added.returncode == 0, added.stderr
    assert _coaxial(folder, "user", "list").stdout == "anna\tsurgeon\nben\toperator\n"


def test_a_user_that_cannot_be_added_is_refused_with_a_code(folder):
    again = _coaxial(folder, "user", "add", "anna", "--role", "auditor", **_SECRETS)
    assert (again.returncode, again.stderr.split(":")[0]) == (3, "user_exists")
    short = _coaxial(folder, "user", "add", "eve", "--role", "auditor", stdin="short\n1\n")
    assert (short.returncode, short.stderr.split(":")[0]) == (3, "user_refused")


def test_help_loads_neither_web_stack_nor_database(tmp_path):
    code = (
        "import sys, service.cli.serve, service.cli.user\n"
        "print([name for name in ('fastapi', 'sqlalchemy', 'pydantic', 'numpy', 'pynetdicom') if name in sys.modules])"
    )
    started_s = time.monotonic()
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert loaded.stdout == "[]\n"
    assert time.monotonic() - started_s < 5.0
