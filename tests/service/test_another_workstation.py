"""A workstation dies in the middle of a case: another one claims the room with a reason, and holds the case."""

import asyncio
import shutil
import sqlite3
from contextlib import closing

import pytest

from robot.arm_claim import ArmClaim
from robot.errors import ArmClaimedError
from service.app import create_app
from service.auth.permissions import Role
from service.errors import ErrorCode, ServiceError
from service.motion import arm_claim
from service.settings import DicomSettings, HttpSettings, Settings
from simulator.controller import ControllerProcess, ControllerSettings, free_loopback_address

TARGETS = [{"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}]


def _settings(folder) -> Settings:
    return Settings(data_folder=folder, min_free_bytes=0, http=HttpSettings(port=0), dicom=DicomSettings(port=0))


async def _start(settings: Settings) -> None:
    app = create_app(settings)
    async with app.router.lifespan_context(app):
        pass


@pytest.fixture
def left(tmp_path, serving, device_files):
    """The data of a workstation that died with an open case, on another one's disk; and the case's id."""
    first, second = tmp_path / "first", tmp_path / "second"
    with serving(_settings(first)) as service, service.client(Role.SURGEON) as client:
        for kind, content in device_files.items():
            client.post(f"/devices/{kind}", content=content)
        case = {"patient_id": "P1", "study_uid": "1.2.3", "targets": TARGETS}
        opened = client.post("/cases", json=case, headers={"Idempotency-Key": "1"}).json()
        shutil.copytree(first, second)
    with closing(sqlite3.connect(second / "coaxial.sqlite")) as copy:
        copy.execute("UPDATE room_claims SET holder = 'process 7 on the dead one'")
        copy.commit()
    return second, opened["id"]


def test_the_room_is_claimed_with_a_reason_and_its_case_is_held(left, serving):
    folder, case_id = left
    with pytest.raises(ServiceError) as refusal:
        asyncio.run(_start(_settings(folder)))
    assert refusal.value.code == ErrorCode.ROOM_LEFT
    with serving(_settings(folder), "its disk broke") as service, service.client(Role.AUDITOR) as client:
        status = client.get(f"/cases/{case_id}/status").json()
        assert (status["state"], status["held_for"]) == ("safe_hold", "restarted")
        claims = client.get("/audit", params={"action": "room_claimed"}).json()
    assert "its disk broke" in str(claims)
    with serving(_settings(folder)):  # its own now
        pass


@pytest.fixture
def controller():
    with ControllerProcess(ControllerSettings(address=free_loopback_address())) as process:
        yield process


@pytest.mark.hazard("H19")
def test_a_service_does_not_start_on_an_arm_that_another_one_runs(controller, monkeypatch):
    monkeypatch.setattr(arm_claim, "_FREED_WITHIN_S", 0.3)
    other = ArmClaim(controller.address)
    other.take()
    with pytest.raises(ServiceError) as refusal:
        arm_claim.refuse_claimed_arm(controller.address)
    assert refusal.value.code == ArmClaimedError.code
    other.give_up()
    arm_claim.refuse_claimed_arm(controller.address)


def test_an_arm_that_is_away_keeps_nobody_from_starting():
    arm_claim.refuse_claimed_arm(None)
    arm_claim.refuse_claimed_arm(free_loopback_address())
