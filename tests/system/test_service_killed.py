"""SIGKILL of the service: the next one starts in safe_hold with the history whole, and nothing moves by itself."""

import time

import numpy as np
import pytest

from tests.system.walk import lifting

# What leads to a state is the same way again and again: make test kills where the record differs, make test-kills
# everywhere.
_TOLD_APART = ("carm_positioned", "registered", "moved", "verified", "inserting", "safe_hold")
_BETWEEN = ("case_open", "image_acquired", "target_chosen", "off_target", "sleeve_inserted")
_STATES = [*_TOLD_APART, *(pytest.param(state, marks=pytest.mark.lengthy) for state in _BETWEEN)]


def _killed_and_started(service, controller, case):
    """The same case through the next service, after what it was before the kill."""
    before = case.record()
    service.kill()
    service.start()
    with service.sign_in() as client:
        again = client.case(case.id)
        status, record = again.status(), again.record()
        assert status["state"] == "safe_hold"
        assert record[: len(before)] == before
        assert record[len(before)]["trigger"] == "restarted"
        assert {status["chain"][link] for link in ("view", "image", "registration", "target", "permit")} == {None}
        _stays(controller)
        return status, record


def _stays(controller) -> None:
    end_s = time.monotonic() + 2.0
    while controller.state().moving:
        assert time.monotonic() < end_s, "the arm goes on"
    before = np.array(controller.state().joints_rad)
    time.sleep(0.5)
    assert np.array_equal(before, controller.state().joints_rad)
    assert controller.state().program == ""


@pytest.fixture
def killable(service, controller, prepared_case):
    """A case of the service that runs now; another one runs afterwards."""
    with service.sign_in() as client:
        yield prepared_case(client)
    with service.sign_in() as client:
        open_case = client.status()["open_case"]
        if open_case is not None:
            client.case(open_case).command("case-aborted", reason="end of the test")


@pytest.mark.hazard("H17")
@pytest.mark.timeout(300)
@pytest.mark.parametrize("state", _STATES)
def test_after_a_kill_the_case_is_held_with_its_history_whole(service, controller, killable, carm, lead, state) -> None:
    before = lead(killable, carm).to(state)
    status, _ = _killed_and_started(service, controller, killable)
    assert status["held_for"] == ("stop" if state == "safe_hold" else "restarted")  # the first cause stays
    assert status["guide"] == before["guide"]
    assert status["insertion"] == before["insertion"]


@pytest.mark.hazard("H17")
@pytest.mark.timeout(300)
def test_a_kill_during_a_motion_stops_the_arm_and_the_journal_has_the_rest(service, controller, killable) -> None:
    with lifting(killable, controller, 80.0):
        _, record = _killed_and_started(service, controller, killable)
    restarted = next(event for event in record if event["trigger"] == "restarted")
    assert len(restarted["data"]["imported_motions"]) == 1
