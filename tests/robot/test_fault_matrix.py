"""Every fault in every state of a motion: the arm stops, a typed event says why, and nothing moves it afterwards.

Marked `matrix`, the cells that are not among the few of `make test` run with `make fault-matrix`.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

import numpy as np
import pytest

from robot.dashboard import stop_by_dashboard
from robot.errors import GuardDownError
from robot.guard.client import GuardConfig
from robot.guard.messages import BeginMove, Disturbed, Fault, MotionEnded, MoveRefused, Phase
from simulator.controller import ControllerProcess, ControllerSettings, Payload, free_loopback_address
from simulator.controller import Fault as Planted
from tests.robot.bench import Bench
from tests.simulator.rtde_client import InUseError, RtdeClient

pytestmark = pytest.mark.real_time

MOTION_COMMANDS = {1, 2, 3, 4, 45}
MOVE_INPUTS = ["input_int_register_0", *(f"input_double_register_{i}" for i in range(8)), "input_int_register_1"]


class When(StrEnum):
    """What the arm does when the fault comes."""

    AWAITED = "awaited"  # the button is held, the motion not yet asked for; it is, a moment after the fault
    STARTING = "starting"  # control is being taken, or was and the motion is about to be put on the wire
    MOVING = "moving"
    SETTLING = "settling"  # at the goal, and not yet at rest for long enough
    RESTING = "resting"  # after an arrival
    LOCKED = "locked"  # a stop is not acknowledged, or a sleeve is being inserted


class Scene:
    """A bench, what was heard of it, and what other clients of the controller a fault needs."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.others: list[RtdeClient] = []
        self.order: BeginMove | None = None
        self._heard = 0
        self._since_s = 0.0

    def come_to(self, when: When) -> None:
        """The state before the fault."""
        if when in (When.AWAITED, When.LOCKED):
            self.bench.permit_id = "permit-1"
            self.bench.hold("permit-1")
        elif when is When.STARTING:
            self._take_control()
        elif when is When.MOVING:
            self.bench.move(60.0)
        else:
            self._arrive(when)
        if when is When.LOCKED:
            self.bench.client.stop("insertion")
            self.bench.until(lambda: self.bench.status.phase is Phase.HELD, 2.0)
        self.order = self.bench.order(self.bench.permit_id)

    def _take_control(self) -> None:
        self.bench.permit_id = "permit-1"
        self.bench.hold("permit-1")
        self.bench.client.begin_move(self.bench.order(step_mm=60.0))
        self.bench.until(lambda: self.bench.status.phase is Phase.STARTING or bool(self.bench.events), 5.0)

    def plant(self, fault: Callable[["Scene"], None]) -> None:
        """The fault, and from when on nothing may move the arm any more."""
        self._heard, self._since_s = len(self.bench.events), time.monotonic()
        fault(self)

    def words(self) -> set[str]:
        """What was told since the fault, as typed."""
        told: set[str] = set()
        for event in self.bench.events[self._heard :]:
            match event:
                case MotionEnded():
                    told.add(event.cause.value)
                case Fault():
                    told.add(event.kind.value)
                case MoveRefused():
                    told.add(event.refusal.code.value)
                case Disturbed():
                    told.add("disturbed")
        return told

    def motion_packets(self, since_s: float | None = None) -> list[str]:
        """Scripts and motion commands that reached the controller since a time, without it since the fault."""
        since_s = self._since_s if since_s is None else since_s
        return [
            f"{record.kind} {record.text}"
            for record in self.bench.controller.wire()
            if record.at_s > since_s and (record.kind == "script" or record.command in MOTION_COMMANDS)
        ]

    def order_again(self) -> str:
        """The same permit once more, still held: the code of its refusal, by whichever guard runs."""
        before, deadline_s = self.bench.count(MoveRefused), time.monotonic() + _GUARD_AGAIN_S
        while self.bench.count(MoveRefused) == before:
            assert time.monotonic() < deadline_s, "no guard answers"
            with suppress(GuardDownError):
                self.bench.client.begin_move(self.order)
            time.sleep(0.5)
        return self.bench.told(MoveRefused).refusal.code.value

    def close(self) -> None:
        for other in self.others:
            other.__exit__()

    def _arrive(self, when: When) -> None:
        bench = self.bench
        bench.permit_id = "permit-1"
        bench.hold("permit-1")
        bench.client.begin_move(bench.order(step_mm=4.0))
        bench.until(lambda: bench.controller.state().tcp_speed_mm_s > 5.0, 5.0)
        bench.until(lambda: not bench.controller.state().moving, 5.0)
        if when is When.RESTING:
            bench.until(lambda: bench.count(MotionEnded) == 1 and bench.status.phase is Phase.IDLE, 3.0)


def planted(fault: Planted) -> Callable[[Scene], None]:
    return lambda scene: scene.bench.controller.inject(fault)


def another_tcp(scene: Scene) -> None:
    flange_from_tcp = np.eye(4)
    flange_from_tcp[2, 3] = 0.3
    scene.bench.controller.set_tcp(flange_from_tcp)


def push(scene: Scene) -> None:
    scene.bench.controller.push(np.array([0.0, 0.3, 0.0]))


def claim(scene: Scene) -> None:
    """A second client asks for the registers, and has them where nobody does."""
    scene.others.append(RtdeClient(scene.bench.controller.address))
    try:
        scene.others[-1].claim(*MOVE_INPUTS)
    except InUseError:
        return


def move_elsewhere(scene: Scene) -> None:
    """A second client on a controller that shares the registers moves the arm aside."""
    claim(scene)
    x, y, z, *turn = _pose(scene)
    scene.others[-1].write(0, *(0.0,) * 8, 0)
    time.sleep(0.05)
    scene.others[-1].write(3, x, y + 0.03, z, *turn, 0.02, 0.5, 1)


def _pose(scene: Scene) -> tuple[float, ...]:
    with RtdeClient(scene.bench.controller.address) as reader:
        reader.subscribe("actual_TCP_pose")
        return reader.read()["actual_TCP_pose"]


LOST = {"feedback_lost", "guard_lost"}
STARTS_NOTHING = {"arm_unreachable", "controller_refused", "feedback_late", *LOST}

_GUARD_AGAIN_S = 30.0  # a guard that ended itself with a broken link starts anew on a busy machine


@dataclass(frozen=True)
class Row:
    """A fault, and the words of which one must be told in each state; a state that is not named tells nothing new.

    While control is taken the fault comes before the motion or amid it, as the machine has it: either's words do.
    """

    name: str
    plant: Callable[[Scene], None]
    told: dict[When, set[str]] = field(default_factory=dict)
    in_test: tuple[When, ...] = (When.MOVING,)
    foreign_packets: int = 0  # motion commands of the second client itself
    # The library connects again by itself before its process has ended, and brings a script that waits for commands.
    uploads: int = 0

    def words(self, when: When) -> set[str]:
        """Of which one must be told."""
        if when is When.STARTING:
            told = self.told.get(When.AWAITED, set()) | self.told.get(When.MOVING, set())
            return told | {"not_started", "no_live_heartbeat", "feedback_late"} if told else told
        return self.told.get(when, set())


def stop_row(fault: Planted, word: str, in_test: tuple[When, ...] = ()) -> Row:
    """A stop of the controller is told in every state in which it is news."""
    everywhere = {when: {word} for when in (When.MOVING, When.SETTLING, When.RESTING, When.LOCKED)}
    return Row(fault.value, planted(fault), everywhere | {When.AWAITED: {word}}, in_test)


def feedback_row(fault: Planted, in_test: tuple[When, ...] = (When.MOVING,), uploads: int = 0) -> Row:
    return Row(
        fault.value,
        planted(fault),
        {
            When.AWAITED: STARTS_NOTHING,
            When.MOVING: {*LOST, "control_lost"},
            When.SETTLING: {*LOST, "control_lost"},
            When.RESTING: LOST,
            When.LOCKED: LOST,
        },
        in_test,
        uploads=uploads,
    )


ROWS = [
    stop_row(Planted.PROTECTIVE_STOP, "protective_stop", (When.SETTLING,)),
    stop_row(Planted.SAFEGUARD_STOP, "safeguard_stop", (When.AWAITED,)),
    stop_row(Planted.ROBOT_EMERGENCY_STOP, "emergency_stop", (When.LOCKED,)),
    stop_row(Planted.SYSTEM_EMERGENCY_STOP, "emergency_stop"),
    stop_row(Planted.SAFETY_VIOLATION, "safety_fault"),
    feedback_row(Planted.TIMESTAMP_STOPS, ()),
    feedback_row(Planted.VALUES_NAN, ()),
    feedback_row(Planted.PACKETS_STOP, ()),
    feedback_row(Planted.PACKETS_OUT_OF_ORDER),
    feedback_row(Planted.BYTES_DRIP),
    feedback_row(Planted.PACKETS_LATE, ()),
    feedback_row(Planted.PACKETS_FALL_BEHIND, ()),
    feedback_row(Planted.RTDE_CLOSED, ()),
    feedback_row(Planted.RTDE_RESET, uploads=2),
    feedback_row(Planted.SWITCHED_OFF),
    # At rest frozen values are what true ones would be; whoever takes control finds out.
    Row(
        "values_freeze",
        planted(Planted.VALUES_FREEZE),
        {
            When.AWAITED: STARTS_NOTHING,
            When.MOVING: LOST,
            When.SETTLING: {"arrived", *LOST},
        },
        (),
    ),
    # The motion that runs is stopped by its own register if need be; the next one finds no way to begin.
    Row(
        "script_port_closed",
        planted(Planted.SCRIPT_PORT_CLOSED),
        {
            When.AWAITED: {"controller_refused", *LOST},
            When.MOVING: {"released"},
            When.SETTLING: {"arrived"},
        },
        (),
    ),
    Row(
        "dashboard_closed",
        planted(Planted.DASHBOARD_CLOSED),
        {
            When.AWAITED: {"controller_refused", *LOST},
            When.MOVING: {"released"},
            When.SETTLING: {"arrived"},
        },
        (),
    ),
    Row(
        "local_control",
        planted(Planted.LOCAL_CONTROL),
        {When.AWAITED: {"controller_refused"}, When.MOVING: {"control_lost"}, When.SETTLING: {"control_lost"}},
        (When.MOVING,),
    ),
    Row(
        "script_killed",
        lambda scene: stop_by_dashboard(scene.bench.controller.address),
        {When.MOVING: {"control_lost"}, When.SETTLING: {"control_lost"}},
        (),
    ),
    Row(
        "tcp_changed",
        another_tcp,
        {
            When.AWAITED: {"tcp_mismatch"},
            When.MOVING: {"tcp_changed"},
            When.SETTLING: {"tcp_changed"},
            When.RESTING: {"disturbed"},
            When.LOCKED: {"disturbed"},
        },
    ),
    Row(
        "payload_changed",
        lambda scene: scene.bench.controller.set_payload(Payload(1.3)),
        {
            When.AWAITED: {"payload_mismatch"},
            When.MOVING: {"payload_changed"},
            When.SETTLING: {"payload_changed"},
        },
    ),
    Row(
        "force_step",
        planted(Planted.FORCE_STEP),
        {When.AWAITED: {"force_at_rest"}, When.MOVING: {"force_rise"}, When.SETTLING: {"force_rise"}},
        (When.MOVING, When.AWAITED),
    ),
    Row(
        "speed_slider_zero",
        lambda scene: scene.bench.controller.set_speed_scaling(0.0),
        {When.AWAITED: {"not_started"}, When.MOVING: {"missed"}, When.SETTLING: {"arrived"}},
        (When.MOVING, When.AWAITED),
    ),
    Row(
        "pushed",
        push,
        {
            When.AWAITED: {"arm_moved_since_permit", "arm_not_at_rest"},
            When.SETTLING: {"missed", "off_path"},
            When.RESTING: {"disturbed"},
            When.LOCKED: {"disturbed"},
        },
        (When.SETTLING,),
    ),
    # Who comes second gets nothing, unless nobody was first.
    Row(
        "registers_claimed",
        claim,
        {When.AWAITED: {"controller_refused"}, When.MOVING: {"released"}, When.SETTLING: {"arrived"}},
        (When.AWAITED,),
    ),
    Row(
        "foreign_motion",
        move_elsewhere,
        {When.MOVING: {"off_path", "control_lost", *LOST}, When.SETTLING: {"off_path", "missed", *LOST}},
        (When.MOVING,),
        foreign_packets=1,
    ),
]
# Nobody pushes an arm that runs, and what is not running is not killed; a foreign client moves nothing by itself then.
NO_CELL = {
    ("pushed", When.MOVING),
    ("pushed", When.STARTING),
    *(("script_killed", when) for when in (When.AWAITED, When.STARTING, When.RESTING, When.LOCKED)),
    *(("foreign_motion", when) for when in (When.AWAITED, When.STARTING, When.RESTING, When.LOCKED)),
}


def cells() -> Iterator[object]:
    for row in ROWS:
        for when in When:
            if (row.name, when) not in NO_CELL:
                marks = () if when in row.in_test else (pytest.mark.matrix,)
                yield pytest.param(row, when, id=f"{row.name}-{when}", marks=marks)


@pytest.fixture
def make_scene(tmp_path: Path) -> Iterator[Callable[[Row], Scene]]:
    made: list[tuple[Scene, ControllerProcess]] = []

    def make(row: Row) -> Scene:
        settings = ControllerSettings(free_loopback_address(), input_registers_exclusive=not row.foreign_packets)
        controller = ControllerProcess(settings)
        scene = Scene(Bench(GuardConfig(controller.address, tmp_path / "journal"), controller))
        made.append((scene, controller))
        scene.bench.start()
        return scene

    yield make
    for scene, controller in made:
        scene.close()
        scene.bench.close()
        controller.close()


@pytest.mark.hazard("H10", "H12", "H18", "H19", "H21")
@pytest.mark.parametrize(("row", "when"), list(cells()))
def test_fault(make_scene: Callable[[Row], Scene], row: Row, when: When) -> None:
    scene = make_scene(row)
    bench, expected = scene.bench, row.words(when)
    scene.come_to(when)
    scene.plant(row.plant)
    if when is When.AWAITED:
        time.sleep(0.3)  # the guard has seen it
        bench.client.begin_move(scene.order)
    if "released" in expected:  # the fault stops nothing, and nothing it breaks is needed for a stop
        time.sleep(0.3)
        assert scene.words() == set() or when is When.STARTING
        bench.held = False
    if expected:
        bench.until(lambda: bool(scene.words() & expected), 15.0)
    over_s = time.monotonic()
    bench.until(lambda: not bench.controller.state().moving, 2.0)
    assert scene.order_again()  # the permit is spent, whatever came of it
    bench.controller.clear()
    bench.stays_at_rest(0.3)
    packets = scene.motion_packets(over_s if when in (When.AWAITED, When.STARTING) else None)
    scripts = [packet for packet in packets if packet.startswith("script")]
    assert len(scripts) <= row.uploads, packets
    assert len(packets) - len(scripts) <= row.foreign_packets, packets
