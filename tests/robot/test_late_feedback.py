"""Feedback that comes steadily and too late: every packet whole, in order and on the wire, told of an arm that was."""

import time

import pytest

from robot.guard.feedback import STALE_S
from robot.guard.messages import EndCause, Fault, FaultKind, MotionEnded, MoveRefused
from robot.refusal import RefusalCode
from simulator.controller import Fault as Planted
from tests.robot.bench import Bench

pytestmark = pytest.mark.real_time

_MOTION_COMMANDS = {1, 2, 3, 4, 45}


@pytest.mark.hazard("H21")
def test_feedback_that_falls_behind_ends_the_motion(bench: Bench) -> None:
    bench.move(60.0)
    bench.controller.inject(Planted.PACKETS_FALL_BEHIND)  # a fifth: 0.1 s late after 0.5 s
    planted_s = time.monotonic()
    ended = bench.told(MotionEnded)
    assert ended.cause is EndCause.FEEDBACK_LOST
    assert bench.first_stop_after(planted_s) < STALE_S / 0.2 + 0.2  # s, the last a crowded machine's
    bench.stays_at_rest()


@pytest.mark.hazard("H21")
def test_feedback_that_falls_behind_without_a_motion_is_a_fault_that_says_how_late_it_is(bench: Bench) -> None:
    bench.controller.inject(Planted.PACKETS_FALL_BEHIND)
    fault = bench.told(Fault)
    assert fault.kind is FaultKind.FEEDBACK_LOST
    late_s = float(fault.message.split()[-3])
    assert 0.05 < late_s <= STALE_S + 0.05  # with what has passed since then it is over the limit
    bench.until(lambda: bench.status.phase == "held", 1.0)


@pytest.mark.hazard("H21")
def test_feedback_that_was_late_from_the_first_packet_on_lets_no_motion_begin(make_bench, controller, tmp_path) -> None:
    controller.inject(Planted.PACKETS_LATE)
    bench = make_bench(controller.address, tmp_path / "journal")
    bench.start()
    newest = controller.wire()[-1].number
    bench.hold("permit-1")
    bench.client.begin_move(bench.order())
    refusal = bench.told(MoveRefused, 15.0).refusal
    assert refusal.code is RefusalCode.FEEDBACK_LATE
    assert refusal.measured > refusal.limit
    assert not [record for record in controller.wire(newest) if record.command in _MOTION_COMMANDS]
