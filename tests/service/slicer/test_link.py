"""What 3D Slicer is told, read by a client of the tests' own."""

import json
import socket
import subprocess
import time

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from service.auth.permissions import Role
from service.settings import DicomSettings, HttpSettings, Settings, SlicerSettings
from service.slicer import messages
from simulator.controller import ControllerProcess, ControllerSettings, free_loopback_address
from tests.service.slicer.openigtlink import Message, read_message

_PLAN = {"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}


def _through_a_socket(message: bytes) -> Message:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        ours.sendall(message)
        return read_message(theirs)


def test_a_pose_arrives_as_it_is():
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec([0.1, -0.7, 2.0]).as_matrix()
    pose[:3, 3] = 12.5, -700.25, 333.0
    message = _through_a_socket(messages.transform(messages.GUIDE, pose))
    assert (message.kind, message.name) == ("TRANSFORM", "BaseFromGuide")
    np.testing.assert_allclose(message.matrix(), pose, atol=1e-4)


def test_an_image_arrives_to_the_bit():
    pixels = np.random.default_rng(5).integers(0, 65536, (48, 64), np.uint16)
    message = _through_a_socket(messages.image(pixels))
    assert (message.kind, message.name) == ("IMAGE", "CoaxialImage")
    np.testing.assert_array_equal(message.pixels(), pixels)


def test_the_target_lies_on_the_goals_axis_towards_the_source():
    base_from_goal = np.eye(4)
    base_from_goal[:3, :3] = Rotation.from_euler("x", 180, degrees=True).as_matrix()
    target = messages.target_beyond(base_from_goal, separation_mm=60.0, depth_mm=80.0)
    np.testing.assert_allclose(target[:3, 3], [0.0, 0.0, 140.0], atol=1e-9)


@pytest.fixture
def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


@pytest.fixture
def watched(tmp_path, databases, serving, free_port):
    """A service that may be watched, its arm simulated; the controller's address is free."""
    controller = ControllerProcess(ControllerSettings(free_loopback_address()))
    with databases.migrated(tmp_path) as address, controller as arm:
        settings = Settings(
            data_folder=tmp_path,
            database_url=address,
            min_free_bytes=0,
            arm_address=arm.address,
            http=HttpSettings(port=0),
            dicom=DicomSettings(port=0, accepted_callers=("STORESCU",)),
            slicer=SlicerSettings(port=free_port),
        )
        with serving(settings) as service:
            yield service, arm


def _next(connection: socket.socket, name: str) -> Message:
    give_up = time.monotonic() + 30
    while time.monotonic() < give_up:
        message = read_message(connection)
        if message.name == name:
            return message
    raise AssertionError(f"no {name}")


@pytest.mark.real_time
def test_whoever_watches_is_told_the_pose_the_state_and_the_image(
    watched, free_port, device_files, storescu, make_xray, tmp_path
):
    service, arm = watched
    with socket.create_connection(("127.0.0.1", free_port), 10) as connection:
        connection.settimeout(10)
        assert json.loads(_next(connection, "CoaxialStatus").text()) == {"case": None, "state": "no_case"}
        _open_case(service, device_files)
        told = json.loads(_next(connection, "CoaxialStatus").text())
        assert told["state"] == "case_open"
        assert set(told) == {"case", "state", "version"}, "who the patient is, nobody is told"
        pose = _next(connection, "BaseFromGuide").matrix()
        state = arm.state()
        np.testing.assert_allclose(pose, state.base_from_flange_nominal @ state.flange_from_tcp, atol=0.01)
        (tmp_path / "image.dcm").write_bytes(make_xray(320, 256))
        port = str(service.parts.dicom_port)
        subprocess.run([storescu, "127.0.0.1", port, tmp_path / "image.dcm"], check=True, timeout=30)
        assert _next(connection, "CoaxialImage").pixels().shape == (320, 256)


def _open_case(service, device_files) -> None:
    with service.client(Role.SURGEON) as client:
        for kind, content in device_files.items():
            client.post(f"/devices/{kind}", content=content).raise_for_status()
        body = {"patient_id": "P1", "study_uid": "1.2.3", "targets": [_PLAN]}
        client.post("/cases", json=body, headers={"Idempotency-Key": "k"}).raise_for_status()


@pytest.mark.real_time
def test_a_watcher_that_leaves_or_talks_disturbs_nobody(watched, free_port):
    with socket.create_connection(("127.0.0.1", free_port), 10) as talking:
        talking.sendall(b"\xff" * 100_000)
    with socket.create_connection(("127.0.0.1", free_port), 10) as connection:
        connection.settimeout(10)
        assert json.loads(_next(connection, "CoaxialStatus").text())["state"] == "no_case"
