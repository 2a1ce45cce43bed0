"""Emergency access in every state: one request stops the arm, leaves it to the pendant and holds the case."""

import time
from collections.abc import Callable, Iterator

import pytest

from service.auth.permissions import Role
from service.settings import DicomSettings, HttpSettings, Settings
from simulator.controller import ControllerProcess, ControllerSettings, free_loopback_address
from tests.service.any_state import NamedApart
from workflow.states import OVER, State
from workflow.triggers import Trigger

pytestmark = pytest.mark.real_time


def _await(happened: Callable[[], bool]) -> None:
    give_up_s = time.monotonic() + 30.0
    while not happened():
        assert time.monotonic() < give_up_s
        time.sleep(0.02)


@pytest.fixture(scope="module")
def controller() -> Iterator[ControllerProcess]:
    with ControllerProcess(ControllerSettings(free_loopback_address())) as process:
        yield process


@pytest.fixture(scope="module")
def running(tmp_path_factory, databases, serving, controller):
    """A service with an arm."""
    folder = tmp_path_factory.mktemp("service")
    ports = {"http": HttpSettings(port=0), "dicom": DicomSettings(port=0)}
    with (
        databases.empty(folder) as address,
        serving(
            Settings(
                data_folder=folder, database_url=address, min_free_bytes=0, arm_address=controller.address, **ports
            )
        ) as service,
    ):
        yield service


@pytest.mark.hazard("H18")
@pytest.mark.parametrize("state", State)
def test_one_request_of_anybody_stops_leaves_the_arm_to_the_pendant_and_holds_the_case(
    room, running, controller, state
) -> None:
    _await(lambda: room.case.status()["arm"]["connected"])
    before = room.put(NamedApart().to(state).case)
    newest = controller.wire()[-1].number
    with running.client(Role.AUDITOR) as anybody:
        answer = anybody.post(f"/cases/{before.case_id}/emergency-access")
    assert answer.status_code == 200
    told = answer.json()
    assert (told["sent_to_guard"], told["pendant_released"], told["recorded"]) == (True, True, True)
    _await(lambda: any(record.text == "stop" for record in controller.wire(newest)))
    after = room.stands()
    assert after.state is (state if state in OVER else State.SAFE_HOLD)
    assert after.permit is None
    stop = next(event for event in reversed(room.case.record()) if event["trigger"] == Trigger.STOP)
    assert (stop["version"], stop["data"]["emergency_access"]) == (told["version"], True)
