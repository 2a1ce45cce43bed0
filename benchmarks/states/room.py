"""The whole service behind a real socket, in a room whose arm, clock and image work are scripted.

Everything between the socket and the guard's client is the product: routes, rules, database, ledger, observer, image
flow. Replaced are the guard's client, the vision worker, and the monotonic clock of the rules and the arm's watch.
"""

import asyncio
import gc
import json
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import partial
from http.client import HTTPConnection
from itertools import count
from pathlib import Path
from select import select
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import numpy as np
import uvicorn
from argon2 import PasswordHasher

from benchmarks.states.guard import Clock, ScriptedGuard
from benchmarks.states.images import ScriptedVision
from robot.guard.pauses import spare_what_is_loaded
from robot.path import plan_path
from robot.tool import read_tool
from service import assembly
from service.app import create_app
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.conductor import background, goals
from service.conductor.conductor import Conductor
from service.motion import bridge, hold
from service.motion.arm_watch import ArmWatch
from service.parts import Parts
from service.serving import server_config
from service.settings import DicomSettings, HttpSettings, SessionSettings, Settings

PASSWORD, PIN = "correct horse", "2468"
TARGET = {"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}
_DEVICES = Path(__file__).parents[2] / "tests" / "devices"
_KINDS = {"guide": "guide", "carm": "flat-panel", "tcp": "tcp", "room": "room"}
_PARKED_RAD = np.deg2rad([0.0, -90.0, 90.0, -90.0, -90.0, 0.0])
_PATIENCE_S = 60.0  # for what the service does by itself; a crowded machine takes its time
_LOOK_S = 0.001
Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Answer:
    """What came back."""

    status: int
    body: Any

    @property
    def code(self) -> str | None:
        """Of a refusal; None where the request was taken."""
        return None if self.status < 400 else str(self.body["code"])


class Line:
    """One connection to the service, kept open; a request is sent once."""

    def __init__(self, port: int) -> None:
        self._connection = HTTPConnection("127.0.0.1", port, timeout=_PATIENCE_S)

    def send(self, method: str, path: str, token: str, body: object = None, **headers: str) -> Answer:
        """A request below /api; a body of bytes goes as it is, any other as JSON."""
        content = body if isinstance(body, bytes) or body is None else json.dumps(body).encode()
        told = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}
        if self._is_hung_up:
            self.close()  # the next request calls again
        self._connection.request(method, f"/api{path}", content, told | _header_names(headers))
        response = self._connection.getresponse()
        text = response.read()
        if response.status >= 500:
            self.close()  # the service hangs up after a fault of its own; the next request calls again
        return Answer(response.status, json.loads(text) if text else None)

    @property
    def _is_hung_up(self) -> bool:
        """Whether the service ended a connection that was silent for long, as on a crowded machine."""
        socket = self._connection.sock
        return socket is not None and bool(select([socket], [], [], 0.0)[0])

    def close(self) -> None:
        """Hang up."""
        self._connection.close()


def _header_names(headers: Mapping[str, str]) -> dict[str, str]:
    return {name.replace("_", "-"): value for name, value in headers.items()}


@dataclass
class Room:
    """A running service, its scripted surroundings, and a session of each person by name."""

    port: int
    parts: Parts
    conductor: Conductor
    guard: ScriptedGuard
    vision: ScriptedVision
    clock: Clock
    tokens: dict[str, str]
    line: Line = field(init=False)
    drift_known: bool = False  # the arm's last motion arrived, and none has begun since
    seconds: "count[int]" = field(default_factory=lambda: count(1))  # of the C-arm's clock, one an image

    def __post_init__(self) -> None:
        self.line = Line(self.port)

    def next_second(self) -> int:
        """Of the C-arm's own clock, which goes on from case to case."""
        return next(self.seconds)

    def upload_devices(self, version: str = "1") -> dict[str, str]:
        """A file of each kind, under a version; ids by kind."""
        ids = {}
        for kind, name in _KINDS.items():
            content = (_DEVICES / f"{name}.toml").read_text()
            content = content.replace("version = 1", f"version = {version}").replace('"1"', f'"{version}"')
            ids[kind] = str(
                self.line.send("POST", f"/devices/{kind}", self.tokens["surgeon"], content.encode()).body["id"]
            )
        return ids

    def wait(self, condition: Callable[[], object]) -> bool:
        """Wait for what the service does by itself; whether it came."""
        end_s = time.monotonic() + _PATIENCE_S
        while not condition():
            if time.monotonic() > end_s:
                return False
            time.sleep(_LOOK_S)
        return True


@contextmanager
def scripted_room(folder: Path, database_url: str | None = None) -> Iterator[Room]:
    """The service on a data folder and an empty database, in a thread with an event loop of its own."""
    clock, vision = Clock(), ScriptedVision()
    tool = read_tool((_DEVICES / "tcp.toml").read_bytes())
    guard = ScriptedGuard(clock, tool, _PARKED_RAD)
    settings = _settings(folder, database_url)
    with ExitStack() as stack:
        for where, name, what in (
            (background, "refuse_claimed_arm", lambda _address: None),
            (background, "Conductor", partial(Conductor, clock=clock)),
            (bridge, "GuardClient", guard),
            (bridge, "ArmWatch", partial(ArmWatch, clock, clock)),
            (hold, "time", SimpleNamespace(monotonic=clock)),
            (assembly, "VisionWorker", lambda _settings: vision),
            (goals, "plan_path", _once_each(plan_path)),
        ):
            stack.enter_context(patch.object(where, name, what))
        app, port = stack.enter_context(_served(settings))
        parts: Parts = app.state.parts
        room = Room(port, parts, app.state.conductor, guard, vision, clock, _people(parts))
        stack.callback(room.line.close)
        spare_what_is_loaded()  # as `coaxial serve` does
        stack.callback(gc.unfreeze)
        yield room


def _settings(folder: Path, database_url: str | None) -> Settings:
    more: Json = {} if database_url is None else {"database_url": database_url}
    return Settings(
        data_folder=folder,
        min_free_bytes=0,
        arm_address="127.0.0.1",
        http=HttpSettings(port=0),
        dicom=DicomSettings(port=0, accepted_callers=("CARM",)),
        session=SessionSettings(wrong_answers=10**9),  # wrong PINs are part of the sequences
        **more,
    )


def _people(parts: Parts) -> dict[str, str]:
    """A session of one user of each role, and of a second surgeon."""
    users = UserStore(parts.database, PasswordHasher(1, 8, 1))
    people = {role.value: role for role in Role} | {"second": Role.SURGEON}
    return {name: parts.sessions.create(users.add(name, role, PASSWORD, PIN))[0] for name, role in people.items()}


def _once_each(plan: Callable[..., Any]) -> Callable[..., Any]:
    """The path check asked once for each question: the arm always starts from the same place."""
    known: dict[tuple[bytes, ...], Any] = {}

    def planned(way: Any, *others: Any) -> Any:
        asked = (
            way.joints_rad.tobytes(),
            way.base_from_start.tobytes(),
            way.base_from_goal.tobytes(),
            bytes([way.leaving]),
        )
        if asked not in known:
            known[asked] = plan(way, *others)
        return known[asked]

    return planned


@contextmanager
def _served(settings: Settings) -> Iterator[tuple[Any, int]]:
    app = create_app(settings)
    server = uvicorn.Server(server_config(app, settings))
    failed: list[BaseException] = []

    async def serve() -> None:
        async with app.router.lifespan_context(app):
            await server.serve()

    def run() -> None:
        try:
            asyncio.run(serve())
        except Exception as error:  # noqa: BLE001  said in the thread that waits for the service
            failed.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    try:
        end_s = time.monotonic() + _PATIENCE_S
        while not server.started and not failed and time.monotonic() < end_s:
            time.sleep(0.01)
        if not server.started:
            raise RuntimeError("the service did not start") from next(iter(failed), None)
        yield app, server.servers[0].sockets[0].getsockname()[1]
    finally:
        server.should_exit = True
        thread.join()
