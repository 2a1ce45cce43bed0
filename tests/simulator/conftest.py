"""Controllers and real clients for the tests, each in a process of its own."""

import json
import select
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from simulator.controller import ControllerProcess, ControllerSettings, free_loopback_address
from tests.waiting import until


class UrRtdeClient:
    """A process that holds the ur-rtde interfaces; killed at the end, whatever they hang in."""

    def __init__(self, address: str) -> None:
        script = Path(__file__).with_name("ur_rtde_client.py")
        self.process = subprocess.Popen(
            [sys.executable, str(script), address],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            bufsize=1,
        )

    def open(self, *kinds: str) -> None:
        for kind in kinds:
            self.call(kind, "open")

    def control(self, method: str, *arguments: Any) -> Any:
        return self.call("control", method, *arguments)

    def receive(self, method: str, *arguments: Any) -> Any:
        return self.call("receive", method, *arguments)

    def dashboard(self, method: str, *arguments: Any) -> Any:
        return self.call("dashboard", method, *arguments)

    def call(self, kind: str, method: str, *arguments: Any, timeout_s: float = 20.0) -> Any:
        self.send(kind, method, *arguments)
        return self.answer(timeout_s)

    def send(self, kind: str, method: str, *arguments: Any) -> None:
        self.process.stdin.write(json.dumps([kind, method, arguments]) + "\n")
        self.process.stdin.flush()

    def answer(self, timeout_s: float = 20.0) -> Any:
        if not select.select([self.process.stdout], [], [], timeout_s)[0]:
            raise TimeoutError("the client does not answer")
        line = self.process.stdout.readline()
        if not line:
            raise ConnectionError(f"the client's process ended with {self.process.wait()}")
        answer = json.loads(line)
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer["value"]

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()


@pytest.fixture
def start_controller() -> Iterator[Callable[..., ControllerProcess]]:
    running: list[ControllerProcess] = []

    def start(**settings: Any) -> ControllerProcess:
        running.append(ControllerProcess(ControllerSettings(free_loopback_address(), **settings)))
        return running[-1]

    yield start
    for controller in running:
        controller.close()


@pytest.fixture
def controller(start_controller: Callable[..., ControllerProcess]) -> ControllerProcess:
    return start_controller()


@pytest.fixture
def start_client() -> Iterator[Callable[..., UrRtdeClient]]:
    running: list[UrRtdeClient] = []

    def start(controller: ControllerProcess, *kinds: str) -> UrRtdeClient:
        running.append(UrRtdeClient(controller.address))
        running[-1].open(*kinds)
        return running[-1]

    yield start
    for client in running:
        client.close()


@pytest.fixture
def wait_until() -> Callable[..., None]:
    """Wait for a condition, 10 s if not told otherwise."""
    return lambda condition, within_s=10.0: until(condition, within_s)
