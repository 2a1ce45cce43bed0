"""Trials of the evidence: requests that schemathesis makes of the interface description, as each role and as nobody.

A trial is one operation, one role, and data that fit the description or do not. No answer may be of 5xx: those that the
description itself has (a disk that is full, a guard that is down) cannot come about here.
"""

import random
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from uuid import uuid4

import cv2
import httpx
import numpy as np
import requests
import schemathesis
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.errors import Unsatisfiable
from schemathesis import GenerationMode

from benchmarks.evidence.item import Trial
from service.app import create_app
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.cases import store
from service.cases.preconditions import etag
from service.settings import DicomSettings, HttpSettings, Settings
from tests.service.conftest import PIN, RunningService, serve_in_thread

OF_A_TRIAL = 50  # requests
_CALLERS = (*Role, None)
_MODES = (GenerationMode.POSITIVE, GenerationMode.NEGATIVE)
_REAL = 0.8  # share of the requests that ask for what is there
_ENDLESS = "/events"  # the stream of a case that there is ends with the case
_TIMEOUT_S = 60.0  # on a crowded machine
_DRAWN = settings(database=None, deadline=None, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
_DEVICES = Path(__file__).parents[2] / "tests" / "devices"
_FILES = {"guide": "guide.toml", "carm": "flat-panel.toml", "tcp": "tcp.toml", "room": "room.toml"}
_CASE = {
    "patient_id": "P1",
    "study_uid": "1.2.3",
    "targets": [{"name": "L3", "entry_mm": [0.0, 0.0, 0.0], "target_mm": [0.0, 40.0, 0.0]}],
}


@schemathesis.serializer("application/toml", "application/dicom", "image/png", "image/tiff")
def _as_bytes(_context: Any, value: Any) -> bytes:
    """What is no JSON, as it was made up."""
    return value if isinstance(value, bytes) else str(value).encode(errors="replace")


def trials(_folder: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """Operation, role and kind of data change with the number, in this order."""
    warnings.simplefilter("ignore")  # of the generator
    with TemporaryDirectory() as place, _serving(Path(place)) as service:
        room = _Room(service)
        described = schemathesis.openapi.from_dict(create_app(Settings()).openapi())
        operations = [one.ok() for one in described.get_all_operations()]
        for number in numbers:
            turn, which = divmod(number, len(operations))
            caller = _CALLERS[turn % len(_CALLERS)]
            mode = _MODES[turn // len(_CALLERS) % len(_MODES)]
            yield {"number": number} | _trial(room, operations[which], caller, mode, number)


@contextmanager
def _serving(folder: Path) -> Iterator[RunningService]:
    any_port = {"http": HttpSettings(port=0), "dicom": DicomSettings(port=0)}
    yield from serve_in_thread(Settings(data_folder=folder, min_free_bytes=0, **any_port))


class _Room:
    """The service, a case and an image in it, and who speaks."""

    def __init__(self, service: RunningService) -> None:
        self.url = service.url
        self._parts = service.parts
        self._users = {user.role: user for user in UserStore(service.parts.database).list()}
        self._http = httpx.Client(base_url=f"{service.url}/api", timeout=_TIMEOUT_S, headers=self.session(Role.SURGEON))
        for kind, name in _FILES.items():
            self._http.post(f"/devices/{kind}", content=(_DEVICES / name).read_bytes()).raise_for_status()
        picture = cv2.imencode(".png", np.zeros((256, 256), np.uint8))[1].tobytes()
        stored = self._http.post("/images", content=picture, headers={"Content-Type": "image/png"})
        self._names = {"image_id": stored.json()["id"], "name": "L3", "kind": "guide"}

    def session(self, role: Role | None) -> dict[str, str]:
        """Of a new one: the last may have been signed out or locked."""
        if role is None:
            return {}
        return {"Authorization": f"Bearer {self._parts.sessions.create(self._users[role])[0]}"}

    def names(self) -> dict[str, str]:
        """Ids of what there is; a case that was closed is followed by another."""
        with self._parts.database.read() as connection:
            is_open = store.open_case_of(connection, self._parts.settings.room)
        return self._names | {"case_id": is_open or self._opened()}

    def intent(self, case_id: str) -> dict[str, str]:
        """What a command on the case's newest state says in its headers."""
        with self._parts.database.read() as connection:
            version = store.newest_event(connection, case_id).version
        return {"If-Match": etag(version), "Idempotency-Key": uuid4().hex}

    def control(self, session: Mapping[str, str]) -> dict[str, str]:
        """The open case's, for a surgeon's session."""
        case_id = self.names()["case_id"]
        headers = {**session, **self.intent(case_id)}
        taken = self._http.post(f"/cases/{case_id}/lease-taken", json={"reason": "evidence"}, headers=headers)
        return {"Control-Token": str(taken.raise_for_status().json()["detail"]["control_token"])}

    def _opened(self) -> str:
        self._http.headers.update(self.session(Role.SURGEON))
        opened = self._http.post("/cases", json=_CASE, headers={"Idempotency-Key": uuid4().hex})
        return str(opened.raise_for_status().json()["id"])


def _trial(room: _Room, operation: Any, caller: Role | None, mode: GenerationMode, number: int) -> Trial:
    """Fifty requests; where the description leaves fewer to be made, the same again."""
    chance, kinds, found = random.Random(number), Counter[str](), list[list[Any]]()
    headers, wire = room.session(caller), requests.Session()
    control = room.control(headers) if caller is Role.SURGEON else {}

    def send(case: Any) -> None:
        _make_real(case, room, control, chance)
        answer = case.call(base_url=room.url, session=wire, headers=headers, timeout=_TIMEOUT_S)
        kinds[f"{caller or 'nobody'}: {answer.status_code // 100}xx"] += 1
        if answer.status_code >= 500:
            found.append([operation.label, answer.status_code, case.as_curl_command()])

    while (left := OF_A_TRIAL - kinds.total()) > 0:
        drawn = settings(_DRAWN, max_examples=left)
        try:
            seed(number * OF_A_TRIAL + left)(drawn(given(case=operation.as_strategy(mode))(send)))()
        except Unsatisfiable:  # whatever is sent fits the description
            mode = GenerationMode.POSITIVE
    return {"kinds": dict(kinds), "bad": len(found), "found": found}


def _make_real(case: Any, room: _Room, control: Mapping[str, str], chance: random.Random) -> None:
    """Mostly a case, an image and a version that there are, control of it, a key that is new, and a known PIN."""
    if chance.random() > _REAL or case.operation.path.endswith(_ENDLESS):
        return
    names = room.names()
    for name in case.path_parameters.keys() & names.keys():
        case.path_parameters[name] = names[name]
    case.headers = {**(case.headers or {}), **control, **room.intent(names["case_id"])}
    if isinstance(case.body, dict) and "pin" in case.body:
        case.body["pin"] = PIN
