"""The screens outside a procedure: a new case, the record of a past one, what the engineer looks after."""

import json
from collections.abc import Callable, Iterator

import pytest

from service.auth.permissions import Role
from tests.service.conftest import RunningService
from tests.tablet.quiet_room import QuietRoom, closed_case
from tests.tablet.tablet import Tablet

_MARKUPS = {
    "markups": [
        {
            "type": "Line",
            "name": "L3-left",
            "coordinateSystem": "RAS",
            "controlPoints": [{"position": [32.25, 85.1, 12.0]}, {"position": [20.0, 40.0, 4.0]}],
        }
    ]
}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[RunningService, str]]:
    with closed_case(tmp_path_factory.mktemp("quiet")) as up:
        yield up


@pytest.fixture
def room(recorded: tuple[RunningService, str], open_tablet: Callable[..., Tablet]) -> QuietRoom:
    return QuietRoom(*recorded, open_tablet)


def test_a_plan_from_3d_slicer_opens_a_case(room):
    tablet = room.tablet_of(Role.SURGEON)
    page, hand = tablet.page, tablet.hand
    hand.tap("New case")
    hand.tap("Open the case")
    page.get_by_text("Some fields cannot be taken").wait_for()
    assert page.locator("input[aria-invalid=true]").count() == 9
    plan = {"name": "spine.mrk.json", "mimeType": "application/json", "buffer": json.dumps(_MARKUPS).encode()}
    page.locator("input[type=file]").set_input_files([plan])
    page.get_by_text("spine.mrk.json: 1 planned paths").wait_for()
    page.get_by_label("Patient id").fill("P2")
    page.get_by_label("Study UID").fill("1.2.4")
    hand.tap("Supine")
    hand.tap("Open the case")
    tablet.is_at("case_open")
    assert _open_case(room)["planned_targets"] == {
        "L3-left": {
            "name": "L3-left",
            "entry_mm": [-32.25, -85.1, 12.0],
            "target_mm": [-20.0, -40.0, 4.0],
            "position": "supine",
        }
    }


def _open_case(room: QuietRoom) -> dict:
    with room.running.client() as client:
        return client.get(f"/cases/{client.get('/status').json()['open_case']}").json()
