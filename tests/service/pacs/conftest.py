"""A case that is over, with one verification of a rendered guide, as the rows that a procedure leaves."""

import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from argon2 import PasswordHasher

from service.auth.permissions import Role
from service.auth.users import UserStore
from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact, NewCase, NewEvent
from service.database.engines import Database
from service.devices.store import DeviceKind, add_device
from service.images.dicom_header import read_header
from service.images.store import NewPurpose, add_image, assign_purpose
from service.settings import DicomSettings
from service.vision_jobs import evaluate, register
from tests.system.carm import CArm
from tests.system.walk import tilted_guide

CASE = "case-1"
_RAW_PX = (514.0, 508.0)


@pytest.fixture(scope="session")
def exposures() -> list[bytes]:
    """Two images of the guide, before and after a motion of some millimetres."""
    carm, files = CArm(None, "P1", "1.2.3"), []  # type: ignore[arg-type]  # it sends nowhere
    for shift_mm in (2.0, 0.2):
        pose = tilted_guide()
        pose[0, 3] += shift_mm
        written = BytesIO()
        carm.image(pose).save_as(written, enforce_file_format=True)
        files.append(written.getvalue())
    return files


@pytest.fixture(scope="session")
def judged(exposures, device_files) -> tuple[dict, dict]:
    """Registration and evaluation of the second image, held against the first."""
    guide, carm = device_files["guide"].encode(), device_files["carm"].encode()
    before, after = (register(image, guide, carm) for image in exposures)
    motion = np.linalg.inv(before["source_from_guide"]) @ np.array(after["source_from_guide"])
    errors = {"arm_sd_deg": 0.1, "arm_sd_mm": 1.0, "tcp_sd_deg": 0.1, "tcp_sd_mm": 1.0}
    known = {
        "image": exposures[0],
        "registration": before,
        "before_from_after": motion.tolist(),
        "errors": errors,
        "handedness_proved": False,
    }
    return after, evaluate(exposures[1], guide, carm, _RAW_PX, 80.0, known)


@pytest.fixture(scope="session")
def add_case_that_is_over(exposures, judged, device_files) -> Callable[[Database, str], None]:
    """Fill the record of a case; `user_id` did it all."""

    def add(database: Database, user_id: str) -> None:
        with database.write() as connection:
            devices = {
                kind: add_device(connection, kind, device_files[kind].encode(), user_id).id for kind in DeviceKind
            }
            case = NewCase(CASE, "room-1", "P1", "1.2.3", user_id, "0" * 64, devices, {"L3 left": {}})
            store.open_case(connection, case, NewEvent("case_opened", user_id, "case_open", {}, {}))
        first, second = (_image(database, content) for content in exposures)
        with database.write() as connection:
            _judge(connection, (first, second), *judged)
            store.append(connection, CASE, NewEvent("case_closed", user_id, "closed", {}, {}), expected_version=None)

    return add


def _image(database: Database, content: bytes) -> str:
    header, problem = read_header(content, DicomSettings())
    with database.write() as connection:
        image = add_image(connection, content, header, problem, {})
    with database.write() as connection:
        purpose = "registration" if image.position == 1 else "verification"
        assign_purpose(connection, NewPurpose(image.id, CASE, purpose, {}, ()))
    return image.id


def _judge(connection, image_ids, registration, figures) -> None:
    first, second = image_ids
    content = {"planned_target": "L3 left", "image_id": first, "raw_px": list(_RAW_PX), "depth_mm": 80.0}
    made = (
        NewArtefact(ArtefactKind.TARGET, "target-1", (first,), content, {}),
        NewArtefact(ArtefactKind.REGISTRATION, "registration-2", (second,), registration, {"image_id": second}),
        NewArtefact(
            ArtefactKind.EVALUATION, "e-1", (second,), figures | {"registration_id": "registration-2"},
            {"image_id": second},
        ),
    )  # fmt: skip
    state = {"target": {"id": "target-1"}}
    event = NewEvent("verification_passed", None, "verified", state, {"image_id": second})
    store.append(connection, CASE, event, expected_version=None, artefacts=made)


@pytest.fixture
def free_ports() -> Callable[[int], list[int]]:
    def ports(count: int) -> list[int]:
        probes = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
        numbers = [probe.getsockname()[1] for probe in probes]
        for probe in probes:
            probe.close()
        return numbers

    return ports


@pytest.fixture
def free_port(free_ports) -> int:
    return free_ports(1)[0]


@pytest.fixture
def program_at_work(tmp_path: Path) -> Callable[..., AbstractContextManager[None]]:
    """A DICOM peer of Debian's on a port; ended at the end of the block."""

    @contextmanager
    def run(port: int, program: str, *arguments: str) -> Iterator[None]:
        found = shutil.which(program)
        assert found, f"{program} is missing: apt-get install dcmtk orthanc"
        with (tmp_path / f"{program}.log").open("a") as log:
            process = subprocess.Popen([found, *arguments], stdout=log, stderr=subprocess.STDOUT)
        try:
            _wait_for(port, process)
            yield
        finally:
            process.terminate()
            process.wait(20)

    return run


def _wait_for(port: int, process: subprocess.Popen) -> None:
    give_up = time.monotonic() + 30
    while time.monotonic() < give_up:
        assert process.poll() is None, "the program ended"
        try:
            socket.create_connection(("127.0.0.1", port), 1).close()
        except OSError:
            time.sleep(0.05)
        else:
            return
    raise AssertionError("the program does not listen")


@pytest.fixture
def users_of() -> Callable[[Database], str]:
    """Add a surgeon to a database; the id."""

    def add(database: Database) -> str:
        hasher = PasswordHasher(time_cost=1, memory_cost=8, parallelism=1)
        return UserStore(database, hasher).add("surgeon", Role.SURGEON, "correct horse", "2468").id

    return add


@pytest.fixture
def surgeon(database, users_of) -> str:
    return users_of(database)
