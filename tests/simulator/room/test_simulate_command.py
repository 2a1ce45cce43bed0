"""`coaxial simulate` as a process."""

import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from simulator.controller import free_loopback_address

_START_TIMEOUT_S = 60.0  # on a busy machine
_COAXIAL = str(Path(sys.executable).with_name("coaxial"))


def _start(*arguments: str) -> subprocess.Popen:
    return subprocess.Popen(
        [_COAXIAL, "simulate", *arguments], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )


def _ended(process: subprocess.Popen) -> tuple[int, str]:
    try:
        _, words = process.communicate(timeout=_START_TIMEOUT_S)
    finally:
        process.kill()
    return process.returncode, words


@pytest.fixture
def address() -> str:
    return free_loopback_address()


@pytest.fixture
def started(address: str) -> Iterator[tuple[subprocess.Popen, str]]:
    process = _start("--port", "0", "--arm-address", address, "--dicom-port", "1")
    urls = (line.split()[-1] for line in process.stderr if line.startswith("Room listens on "))
    yield process, next(urls)
    process.kill()
    process.communicate()


@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGINT])
def test_room_serves_arm_and_door_and_ends_in_order(started, address: str, ending: signal.Signals) -> None:
    process, url = started
    assert httpx.get(f"{url}/room", trust_env=False).json()["arm"]["address"] == address
    assert httpx.get(f"{url}/arm", trust_env=False).json()["safety_mode"] == "normal"
    with socket.create_connection((address, 29999), timeout=5.0) as dashboard:
        assert dashboard.recv(100).startswith(b"Connected")
    process.send_signal(ending)
    assert process.wait(20.0) == 0
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection((address, 29999), timeout=5.0).close()


def test_arm_is_jogged_and_pushed_through_the_door(started) -> None:
    _, url = started
    with httpx.Client(base_url=url, trust_env=False) as door:
        before = door.get("/arm").json()["joints_deg"]
        assert door.post("/arm/push", json={"step_mm": [0.1, 0.0, 0.0]}).status_code == 200
        assert door.post("/arm/jog", json={"joints_deg": [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]}).status_code == 200
        assert door.post("/arm/jog", json={"step_mm": [1.0, 0.0, 0.0]}).status_code == 409  # still moving
        end_s = time.monotonic() + 10.0
        while door.get("/arm").json()["moving"] and time.monotonic() < end_s:
            time.sleep(0.05)
        after = door.get("/arm").json()["joints_deg"]
        assert after[0] - before[0] == pytest.approx(1.0, abs=0.1)
        door.post("/arm/park")
        assert door.get("/arm").json()["joints_deg"] == pytest.approx(before, abs=1e-6)  # as it began


@pytest.mark.parametrize("arguments", [("--arm-address", "192.0.2.7"), ("--truth", "/nonexistent/truth.toml")])
def test_wrong_usage_ends_with_one_line(arguments: tuple[str, ...]) -> None:
    status, words = _ended(_start("--port", "0", *arguments))
    assert status == 2
    assert len(words.splitlines()) == 1
    assert words.startswith("simulate: ")


def test_truth_that_names_no_ct_ends_with_one_line(tmp_path: Path) -> None:
    truth = tmp_path / "truth.toml"
    truth.write_text('[ct]\npath = "absent.nii"\n[ct.pedicles.A]\nentry_mm = [0, 9, 0]\ntarget_mm = [0, 0, 0]\n')
    status, words = _ended(_start("--port", "0", "--arm-address", free_loopback_address(), "--truth", str(truth)))
    assert status == 2
    assert words == f"simulate: no CT at {tmp_path / 'absent.nii'}\n"


def test_taken_port_ends_with_one_line(address: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        status, words = _ended(_start("--port", str(taken.getsockname()[1]), "--arm-address", address))
    assert status == 2
    assert "in use" in words
