"""The door over HTTP, in this process."""

import asyncio
from collections.abc import Callable
from typing import Any

import httpx
import pytest

from simulator.door import create_door
from simulator.pedal import Pedal
from simulator.room import Room

Call = Callable[..., tuple[int, Any]]


@pytest.fixture
def call(room: Room, pedal: Pedal) -> Call:
    transport = httpx.ASGITransport(create_door(room, pedal))

    def call(method: str, path: str, body: Any = None) -> tuple[int, Any]:
        async def ask() -> httpx.Response:
            async with httpx.AsyncClient(transport=transport, base_url="http://room") as client:
                return await client.request(method, path, json=body)

        response = asyncio.run(ask())
        return response.status_code, response.json()

    return call


def test_room_tells_patient_carm_arm_and_devices(call: Call) -> None:
    status, answer = call("GET", "/room")
    assert status == 200
    assert answer["patient"] == {"id": "P1", "name": "Some^One", "position": "prone"}
    assert answer["arm"]["address"] == "127.0.0.2"
    assert set(answer["devices"]) == {"guide", "carm", "tcp", "room"}


def test_flow_from_position_to_pixel_and_errors(call: Call, receiver) -> None:
    assert call("GET", "/pedicles/L3-left/pixel")[0] == 409
    assert call("POST", "/carm/position", {"primary_deg": 169.0, "secondary_deg": 0.0})[0] == 200
    status, approach = call("GET", "/approach?pedicle=L3-left")
    assert (status, len(approach["translation_mm"]), len(approach["rotation_vector_deg"])) == (200, 3, 3)
    status, exposed = call("POST", "/expose", {})
    assert (status, exposed["accepted"]) == (200, True)
    status, pixel = call("GET", "/pedicles/L3-left/pixel")
    assert (status, pixel["sop_uid"]) == (200, exposed["sop_uid"])
    assert all(300.0 < coordinate < 720.0 for coordinate in pixel["pixel_px"])
    assert set(call("GET", "/truth/errors?pedicle=L3-left")[1]) == {"angle_error_deg", "position_error_mm"}


def test_study_counts_for_the_images_after_it_and_an_override_for_one(call: Call, receiver) -> None:
    call("POST", "/study", {"patient_id": "P2", "study_uid": "1.9"})
    call("POST", "/expose", {"patient_id": "P3"})
    call("POST", "/expose")
    assert [image.PatientID for image in receiver.images] == ["P3", "P2"]
    assert [image.StudyInstanceUID for image in receiver.images] == ["1.9", "1.9"]


def test_faults_of_room_and_arm_are_planted_and_cleared_by_name(call: Call) -> None:
    assert call("POST", "/faults/no_plate")[1] == {"planted": ["no_plate"]}
    assert call("POST", "/faults/protective_stop")[1] == {"planted": ["no_plate", "protective_stop"]}
    assert call("DELETE", "/faults/no_plate")[1] == {"planted": ["protective_stop"]}
    assert call("DELETE", "/faults")[1] == {"planted": []}
    assert {"mirrored", "carm_turned", "values_nan"} <= set(call("GET", "/faults")[1]["known"])


@pytest.mark.parametrize(
    ("method", "path", "body", "status"),
    [
        ("POST", "/faults/earthquake", None, 404),
        ("DELETE", "/faults/earthquake", None, 404),
        ("GET", "/pedicles/C1-left/pixel", None, 409),
        ("GET", "/approach?pedicle=C1-left", None, 404),
        ("GET", "/truth/errors?pedicle=C1-left", None, 404),
        ("POST", "/carm/position", {"primary_deg": 0.0, "secondary_deg": 0.0}, 409),
        ("POST", "/carm/position", {"primary_deg": 170.0, "secondary_deg": 0.0, "pedicle": "C1-left"}, 404),
        ("POST", "/carm/position", {"primary_deg": 170.0}, 422),
        ("POST", "/carm/position", {"primary_deg": 170.0, "secondary_deg": 0.0, "speed": 1}, 422),
        ("POST", "/study", {"patient_id": "", "study_uid": "x"}, 422),
        ("POST", "/arm/jog", {}, 409),
        ("POST", "/arm/jog", {"step_mm": [1.0, 2.0]}, 422),
    ],
)
def test_what_the_room_cannot_do_is_a_4xx_with_a_reason(
    call: Call, method: str, path: str, body: Any, status: int
) -> None:
    found, answer = call(method, path, body)
    assert found == status
    assert answer["detail"]
