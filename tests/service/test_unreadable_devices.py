"""A device file that cannot be read any more, as after a stricter update: nothing moves, all else goes on."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from coaxial_client import Coaxial, Refused
from service.auth.permissions import Role
from tests.service.conftest import PASSWORD, _settings

_TARGET = {"name": "L3", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}
_CASE = {"patient_id": "P1", "study_uid": "1.2.3", "targets": [_TARGET]}
_SPOILT = "UPDATE device_files SET content = ? WHERE kind = 'tcp'"


@pytest.fixture(scope="module")
def spoilt(tmp_path_factory, databases, serving, device_files) -> Iterator[tuple[Coaxial, str]]:
    """A room and its open case after a restart, the case's TCP calibration file unreadable since."""
    folder: Path = tmp_path_factory.mktemp("spoilt")
    with databases.empty(folder) as address:
        settings = _settings(folder, address)
        with serving(settings) as service, Coaxial(service.url) as client:
            client.sign_in(Role.SURGEON.value, PASSWORD)
            for kind, content in device_files.items():
                client.upload_device(kind, content.encode())
            case_id = client.open_case(_CASE).id
        with databases.attack(address) as attacker:
            attacker.execute(_SPOILT, [b"nothing"])
        with serving(settings) as service, Coaxial(service.url) as client:
            client.sign_in(Role.SURGEON.value, PASSWORD)
            yield client, f"/cases/{case_id}"


def _code(call: Callable[[], object]) -> str:
    with pytest.raises(Refused) as refused:
        call()
    return refused.value.code


@pytest.mark.hazard("H10")
def test_the_service_starts_stops_and_takes_facts_though_a_device_file_is_unreadable(spoilt, device_files) -> None:
    room, case = spoilt
    assert room.post(f"{case}/stop")["recorded"]
    assert room.post(f"{case}/guide-state-stated", {"guide": "empty"})["state"] == "safe_hold"
    assert _code(lambda: room.get(f"{case}/status")) == "device_refused"
    again = room.upload_device("tcp", device_files["tcp"].replace('version = "1"', 'version = "2"').encode())
    room.post(f"{case}/device-changed", {"devices": {"tcp": again["id"]}})
    assert room.get(f"{case}/status")["state"] == "safe_hold"


@pytest.mark.hazard("H10")
@pytest.mark.parametrize(("kind", "other"), [("guide", "carm"), ("carm", "guide"), ("tcp", "guide"), ("room", "tcp")])
def test_a_file_does_not_take_the_place_of_one_of_another_kind(spoilt, kind, other) -> None:
    room, case = spoilt
    stored = {one["kind"]: one["id"] for one in room.get_list("/devices")}
    assert _code(lambda: room.post(f"{case}/device-changed", {"devices": {kind: stored[other]}})) == "device_unknown"
