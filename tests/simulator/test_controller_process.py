"""The controller's process: what crosses the pipe, what is recorded, and its end."""

import subprocess
import sys
import time

import numpy as np
import pytest

from simulator.controller import Controller, ControllerSettings, Fault, Payload, RobotMode, free_loopback_address
from simulator.controller.addresses import DASHBOARD_PORT, PORTS, RTDE_PORT
from simulator.controller.codec import from_json, to_json
from simulator.controller.state import WireRecord

pytestmark = pytest.mark.real_time


@pytest.mark.parametrize(
    "value",
    [
        None,
        1.5,
        "text",
        (1, (2.0, "three")),
        frozenset({Fault.VALUES_NAN}),
        RobotMode.IDLE,
        Payload(2.0, (1.0, 2.0, 3.0)),
        WireRecord(3, 1.25, RTDE_PORT, "input", "0 1", 40),
    ],
)
def test_values_cross_the_pipe_unchanged(value):
    assert from_json(to_json(value)) == value


def test_settings_cross_the_pipe_with_their_arrays():
    settings = ControllerSettings("127.0.0.9", flange_from_tcp=np.diag([1.0, -1.0, -1.0, 1.0]))
    returned = from_json(to_json(settings))
    assert np.array_equal(returned.flange_from_tcp, settings.flange_from_tcp)
    assert (returned.address, returned.truth, returned.cycle_s) == ("127.0.0.9", settings.truth, 0.008)


def test_foreign_types_do_not_cross_the_pipe():
    with pytest.raises(TypeError):
        to_json(object())


def test_same_interface_in_this_process():
    with Controller(ControllerSettings(free_loopback_address())) as controller:
        controller.inject(Fault.PROTECTIVE_STOP)
        assert controller.state().faults == {Fault.PROTECTIVE_STOP}
        controller.release()
        assert controller.state().faults == frozenset()
    controller.close()


def test_state_holds_the_settings_and_changes_made_at_the_pendant(start_controller):
    controller = start_controller(payload=Payload(1.7, (0.0, 1.0, 60.0)))
    assert controller.state().payload == Payload(1.7, (0.0, 1.0, 60.0))
    flange_from_tcp = np.eye(4)
    flange_from_tcp[2, 3] = 181.0
    controller.set_tcp(flange_from_tcp)
    controller.set_payload(Payload(0.5))
    assert np.array_equal(controller.state().flange_from_tcp, flange_from_tcp)
    assert controller.state().payload == Payload(0.5)


def test_readers_send_no_packet_to_the_arm(controller, start_client):
    client = start_client(controller, "receive", "dashboard")
    client.receive("getActualQ")
    client.dashboard("stop")
    assert [record for record in controller.wire() if record.kind in ("input", "script")] == []
    assert [record.text for record in controller.wire() if record.kind == "dashboard"] == ["stop"]


def test_commands_are_recorded_with_their_arguments_in_order(controller, start_client):
    client = start_client(controller, "control")
    seen = controller.wire()[-1].number
    before_s = time.monotonic()
    client.control("setWatchdog", 2.5)
    client.control("getTCPOffset")
    commands = [record for record in controller.wire(seen) if record.command > 0]
    assert [(record.command, record.text) for record in commands] == [(35, "2.5"), (40, "")]
    assert before_s < commands[0].at_s < commands[1].at_s < time.monotonic()


def test_process_ends_with_its_owner():
    owner = """
import sys, time
from simulator.controller import ControllerProcess, ControllerSettings
controller = ControllerProcess(ControllerSettings(sys.argv[1]))
print(controller.pid, flush=True)
time.sleep(60)
"""
    address = free_loopback_address()
    process = subprocess.Popen([sys.executable, "-c", owner, address], stdout=subprocess.PIPE)
    process.stdout.readline()
    process.kill()
    process.wait()
    process.stdout.close()
    deadline_s = time.monotonic() + 10.0
    while True:
        try:
            Controller(ControllerSettings(address)).close()
            break
        except OSError:
            assert time.monotonic() < deadline_s, "the controller outlived its owner"
            time.sleep(0.05)


def test_free_address_is_loopback_with_three_free_ports():
    address = free_loopback_address()
    assert address.startswith("127.0.")
    assert address != "127.0.0.1"
    with Controller(ControllerSettings(address)):
        assert len(PORTS) == 3
        assert DASHBOARD_PORT in PORTS


def test_no_address_is_given_twice(monkeypatch):
    drawn = iter([7, 7, 7, 7, 7, 8])
    monkeypatch.setattr("random.SystemRandom.randint", lambda *_: next(drawn))
    assert free_loopback_address() == "127.0.7.7"
    assert free_loopback_address() == "127.0.7.8"
