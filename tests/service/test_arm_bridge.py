"""The way to the guard: what it does not take is a fault at once, not silence (H17)."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from robot.guard.client import GuardClient, GuardConfig
from robot.guard.messages import Event, Fault, FaultKind, StopSent
from service.conductor import starting
from service.conductor.starting import start_move
from service.errors import ServiceError
from service.motion.bridge import ArmBridge

MOVE: Any = SimpleNamespace()  # no guard is there to read it


@pytest.fixture
def heard() -> list[Event]:
    return []


@pytest.fixture
def bridge(heard: list[Event], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ArmBridge:
    """A bridge to a guard that takes nothing: its process is gone, and its client has not noticed yet."""
    monkeypatch.setattr(GuardClient, "start", lambda _client: None)
    bridge = ArmBridge(GuardConfig("127.0.0.1", tmp_path))
    bridge.start(heard.append, lambda: None)
    return bridge


def _faults(heard: list[Event]) -> list[FaultKind]:
    return [event.kind for event in heard if isinstance(event, Fault)]


def test_a_motion_that_no_guard_takes_is_a_fault_at_once(bridge, heard) -> None:
    assert bridge.begin_move(MOVE) is False
    assert _faults(heard) == [FaultKind.GUARD_LOST]


def test_a_motion_in_a_room_without_an_arm_is_a_fault_too(heard) -> None:
    bridge = ArmBridge(None)
    bridge.start(heard.append, lambda: None)
    assert bridge.begin_move(MOVE) is False
    assert _faults(heard) == [FaultKind.GUARD_LOST]


def test_an_acknowledgement_that_the_guard_does_not_take_is_a_fault_at_once(bridge, heard) -> None:
    assert bridge.unlock() is False
    assert _faults(heard) == [FaultKind.GUARD_LOST]


def test_a_guard_that_is_kept_locked_for_a_stop_is_no_fault(bridge, heard) -> None:
    bridge.stop_to_record()
    assert bridge.unlock() is True
    assert heard == []


@pytest.fixture
def timed(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Every latency of a stop that was counted."""
    latencies: list[float] = []
    monkeypatch.setattr("service.motion.bridge.count_stop", latencies.append)
    return latencies


def test_a_stop_is_timed_from_its_first_press_to_its_writing(timed, monkeypatch) -> None:
    bridge = ArmBridge(None)
    monkeypatch.setattr("service.motion.bridge.time", SimpleNamespace(monotonic=iter((10.0, 10.01)).__next__))
    bridge.stop("pressed")
    bridge.stop("pressed again")
    bridge._take(StopSent("pressed", 10.02, written=True))
    bridge._take(StopSent("nobody asked", 10.05, written=True))
    assert timed == pytest.approx([0.02])


@pytest.mark.parametrize(("at_s", "written"), [(10.02, False), (9.9, True)])
def test_a_stop_that_did_not_go_out_or_was_another_is_not_timed(timed, monkeypatch, at_s, written) -> None:
    bridge = ArmBridge(None)
    monkeypatch.setattr("service.motion.bridge.time", SimpleNamespace(monotonic=lambda: 10.0))
    bridge.stop("pressed")
    bridge._take(StopSent("pressed", at_s, written))
    assert timed == []


def test_a_stop_that_was_lost_with_its_guard_makes_no_later_one_seem_slow(timed, monkeypatch) -> None:
    bridge = ArmBridge(None)
    monkeypatch.setattr("service.motion.bridge.time", SimpleNamespace(monotonic=iter((10.0, 100.0)).__next__))
    bridge.stop("lost")
    bridge.stop("pressed")
    bridge._take(StopSent("pressed", 100.004, written=True))
    assert timed == pytest.approx([0.004])


def test_a_room_without_an_arm_has_nothing_to_unlock(heard) -> None:
    bridge = ArmBridge(None)
    bridge.start(heard.append, lambda: None)
    assert bridge.unlock() is True
    assert heard == []


def test_whoever_holds_the_button_is_told_that_no_guard_took_the_motion(bridge, heard, monkeypatch) -> None:
    plan = SimpleNamespace(id="plan", content={"kind": "retreat"})
    monkeypatch.setattr(starting, "_plan_of", lambda *_: plan)
    monkeypatch.setattr(starting, "_move", lambda *_: SimpleNamespace(duration_s=1.0))
    devices = SimpleNamespace(tool=None)
    standing = SimpleNamespace(connection=None, case=SimpleNamespace(case_id="case"), devices=devices)

    def perform(_caller: Any, _trigger: Any, prepare: Any) -> None:
        prepare(standing).then(None)

    conductor: Any = SimpleNamespace(bridge=bridge, perform=perform)
    with pytest.raises(ServiceError) as caught:
        start_move(conductor, SimpleNamespace(control_token=1), "permit")
    assert caught.value.code == "guard_down"
    assert _faults(heard) == [FaultKind.GUARD_LOST]
