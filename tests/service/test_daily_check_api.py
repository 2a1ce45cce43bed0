"""The daily check of a room whose arm is away, of one with an open case, and of an image that nobody waits for."""

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from typing import Any

import pytest

from service.auth.permissions import Role
from tests.service.conftest import PASSWORD

TARGETS = [{"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}]
_COMMAND = [sys.executable, "-c", "from service.cli.daily_check import daily_check; daily_check()"]


@pytest.fixture(scope="module")
def engineer(running, device_files):
    with running.client(Role.ENGINEER) as client:
        for kind, content in device_files.items():
            client.post(f"/devices/{kind}", content=content)
        yield client


def test_without_an_arm_the_check_fails_at_once_and_is_recorded(engineer):
    answer = engineer.post("/daily-check", json={}).json()
    assert answer["passed"] is False
    assert [one["code"] for one in answer["items"] if not one["passed"]] == ["arm_reachable"]
    assert engineer.get("/status").json()["daily_check"]["failed"] == ["arm_reachable"]


@pytest.mark.hazard("H10")
def test_a_file_that_has_expired_fails_by_its_kind(engineer, device_files):
    old = device_files["tcp"].replace('version = "1"', 'version = "0"\nexpires = 2020-01-31')
    engineer.post("/devices/tcp", content=old)
    answer = engineer.post("/daily-check", json={}).json()
    engineer.post("/devices/tcp", content=device_files["tcp"].replace('version = "1"', 'version = "2"'))
    [expired] = [one for one in answer["items"] if one["code"] == "tcp_in_date"]
    assert (expired["passed"], expired["measured"]) == (False, "2020-01-31")
    assert "upload" in expired["what_to_do"]


def test_an_image_that_no_check_waits_for_is_refused(engineer):
    assert engineer.post("/daily-check/none/image", json={"image_id": "none"}).json()["code"] == "image_unknown"


def test_the_command_says_what_failed_and_ends_with_3(running):
    environment = os.environ | {"COAXIAL_PASSWORD": PASSWORD}
    done = subprocess.run(
        [*_COMMAND, running.url, "--user", "engineer"], env=environment, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 3, done.stderr
    [failed] = [line for line in done.stdout.splitlines() if line.startswith("FAIL")]
    assert failed.startswith("FAIL  arm_reachable: None")
    assert "Switch the arm on" in failed


@pytest.mark.parametrize("arguments", [["http://127.0.0.1:1", "--user", "engineer"], []])
def test_a_service_that_is_not_there_and_a_wrong_call_end_with_2(arguments):
    environment = os.environ | {"COAXIAL_PASSWORD": PASSWORD}
    done = subprocess.run([*_COMMAND, *arguments], env=environment, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


def _without_password(url: str) -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if name != "COAXIAL_PASSWORD"}
    command = [*_COMMAND, url, "--user", "engineer"]
    return subprocess.run(command, env=environment, input="", capture_output=True, text=True, timeout=60)


@pytest.fixture(params=["text", "404"])
def stranger(request: pytest.FixtureRequest) -> Iterator[str]:
    """The address of something that is no service of a room."""

    class Page(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200 if request.param == "text" else 404)
            self.end_headers()
            self.wfile.write(b"<h1>Printer</h1>\n<p>of ward 3</p>")

        def log_message(self, *_: Any) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Page) as server:
        serving = threading.Thread(target=server.serve_forever)
        serving.start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        serving.join()


def test_an_address_is_tried_before_a_password_is_asked_for(stranger: str) -> None:
    nobody = _without_password("http://127.0.0.1:1")
    assert (nobody.returncode, nobody.stdout) == (2, "")
    assert nobody.stderr.startswith("the service at http://127.0.0.1:1 does not answer: ")
    somebody = _without_password(stranger)
    assert (somebody.returncode, somebody.stdout) == (2, "")
    assert somebody.stderr == f"what answers at {stranger} is no Coaxial service\n"


def test_no_password_is_wrong_usage(running) -> None:
    done = _without_password(running.url)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: no Password was given")


def test_no_check_is_made_beside_an_open_case(running, engineer):
    case = {"patient_id": "P1", "study_uid": "1.2.3", "targets": TARGETS}
    with running.client(Role.SURGEON) as surgeon:
        opened = surgeon.post("/cases", json=case, headers={"Idempotency-Key": "1"}).json()
        assert engineer.post("/daily-check", json={}).json()["code"] == "case_open"
        surgeon.post(f"/cases/{opened['id']}/case-aborted", json={"reason": "end of the test"})
