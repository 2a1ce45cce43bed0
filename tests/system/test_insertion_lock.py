"""While the sleeve goes in nothing moves the arm, its pose is watched, and no stop of it is in the surgeon's way."""

import socket

import numpy as np
import pytest

from coaxial_client import Refused
from simulator.controller import Fault
from simulator.controller.addresses import SCRIPT_PORT
from tests.system.service_process import PIN

_LOCKED = {"insertion_running", "instrument_in_guide"}


def _uploads(controller) -> int:
    return sum(one.kind == "script" for one in controller.wire())


def _refused(ask) -> str:
    with pytest.raises(Refused) as caught:
        ask()
    return caught.value.code


def _nothing_moves(case, controller, old_permit: str) -> None:
    before, joints = _uploads(controller), controller.state().joints_rad
    assert _refused(lambda: case.plan("retreat", distance_mm=20.0)) in _LOCKED
    assert _refused(lambda: case.command("move-approved", plan_id="any", pin=PIN)) in _LOCKED

    def hold() -> None:
        with case.hold(old_permit):
            pass

    assert _refused(hold) in _LOCKED
    arm = case.status()["arm"]
    assert (arm["phase"], arm["program_running"], arm["at_rest"]) == ("held", False, True)
    assert _uploads(controller) == before
    assert np.array_equal(controller.state().joints_rad, joints)


def _alarms(case) -> list[dict]:
    return [event for event in case.record() if "alarm" in event["data"].get("effects", ())]


@pytest.mark.hazard("H29")
@pytest.mark.timeout(300)
def test_inserting_locks_the_arm_watches_it_and_takes_every_fact(walk, controller, until) -> None:
    case = walk.case
    walk.to("inserting")
    permit = next(event for event in reversed(case.record()) if event["trigger"] == "move_approved")
    _nothing_moves(case, controller, permit["data"]["made"]["permit"])

    with socket.create_connection((controller.address, SCRIPT_PORT)) as pendant:
        pendant.sendall(b"def another():\n  movej([0, 0, 0, 0, 0, 0])\nend\n")
        assert case.wait_for("safe_hold")["held_for"] == "program_started"
    until(lambda: not case.status()["arm"]["program_running"])
    assert case.command("acknowledged", guide="instrument")["state"] == "inserting"

    controller.inject(Fault.PROTECTIVE_STOP)  # the drill slipped
    assert case.wait_for("safe_hold")["held_for"] == "protective_stop"
    told = case.command("sleeve-in")
    assert (told["outcome"], told["state"]) == ("taken", "safe_hold")
    assert case.command("note", text="protective stop while drilling")["outcome"] == "taken"
    assert case.status()["insertion"]["status"] == "done"
    controller.release()
    until(lambda: case.status()["arm"]["safety"] == "normal")
    controller.push(np.array([0.2, 0.0, 0.0]))
    until(lambda: not controller.state().moving and case.status()["arm"]["at_rest"])
    assert case.command("acknowledged", guide="instrument")["state"] == "sleeve_inserted"
    assert not _alarms(case)  # pushing bends the arm a little, and that is no alarm, in a hold neither
    assert case.status()["chain"]["verification"] is not None
    controller.push(np.array([0.2, 0.0, 0.0]))
    until(lambda: _alarms(case), 2.0)
    [alarm] = _alarms(case)
    assert alarm["trigger"] == "arm_disturbed"
    assert alarm["data"]["drift_mm"] > 0.3
    status = case.status()
    assert status["chain"]["verification"] is None
    assert status["alarms"] == ["moved_while_the_sleeve_was_in"]
    assert status["insertion"]["flagged"]
