"""What the guard says, writes and keeps count of, beside what it does; over an arm of numbers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from robot.arm import ArmState
from robot.guard.guard import STATUS_S, Guard
from robot.guard.journal import EVENTS_FILE, read_lines
from robot.guard.messages import (
    Acknowledge,
    BeginMove,
    Disturbed,
    EndCause,
    Event,
    Fault,
    FaultKind,
    Heartbeat,
    MotionEnded,
    MotionStarted,
    MoveRefused,
    PendantReleased,
    Phase,
    ReleasePendant,
    Status,
    StopSent,
)
from robot.refusal import RefusalCode
from robot.safety import SafetyState
from tests.robot.conftest import displaced_arm
from tests.robot.guarded_arm import TURN_S, Room, begin, ended


def told(room: Room, kind: type[Event]) -> list[Event]:
    return [event for event in room.events if isinstance(event, kind)]


def displaced(reading: ArmState, x_mm: float) -> ArmState:
    pose, joints_rad = displaced_arm(x_mm, 0.0)
    return replace(reading, base_from_tcp=pose, joints_rad=joints_rad)


def test_a_status_goes_out_forty_times_a_second_and_no_more_often(room: Room) -> None:
    room.events.clear()
    for _ in range(1000):
        room.turn(0.001)
    statuses = told(room, Status)
    assert 35 <= len(statuses) <= 40
    assert [one.sequence for one in statuses] == list(range(statuses[0].sequence, statuses[0].sequence + len(statuses)))
    assert len({one.challenge for one in statuses}) == len(statuses)


def test_the_first_status_goes_out_at_once_however_young_the_machine_and_the_next_when_it_is_due(room: Room) -> None:
    room.read = lambda: None
    turns_s, told_of = iter((0.0, 0.999 * STATUS_S, STATUS_S)), []
    guard = Guard(room, room.journal, told_of.append, lambda: next(turns_s))
    told_by = [(guard.tick(), len(told_of))[1] for _ in range(3)]
    assert told_by == [1, 1, 2]


def test_a_motion_is_told_from_its_permit_to_its_end(room: Room, move: BeginMove, tmp_path: Path) -> None:
    begin(room, move)
    turns = 5
    for number in range(2, 2 + turns):
        room.beat(number)
        room.turn()
    room.guard.handle(room.guard.stop_now("asked"))
    assert ended(room) is EndCause.STOPPED
    kinds = [type(event) for event in room.events if not isinstance(event, Status)]
    assert kinds == [MotionStarted, StopSent, MotionEnded]
    end = room.newest(MotionEnded)
    assert end.stop_sent_at_s == room.newest(StopSent).at_s
    at_the_end = read_lines(tmp_path / end.trajectory_file)  # written by the time that it is told
    assert len(at_the_end) == end.trajectory_samples
    turned = round((end.at_s - room.newest(MotionStarted).at_s) / TURN_S)
    assert end.trajectory_samples == turned > turns  # the rest after the stop belongs to it
    assert room.journal.flush(5.0)
    written = [line["type"] for line in read_lines(tmp_path / EVENTS_FILE)]
    assert written == ["acknowledge", "begin_move", "motion_started", "stop_sent", "motion_ended"]


def test_each_event_comes_after_the_status_that_belongs_to_it(room: Room, move: BeginMove) -> None:
    phases: list[Phase] = []
    room.while_control_is_taken = lambda: phases.append(room.newest(Status).phase)
    begin(room, move)
    assert phases == [Phase.STARTING]  # the parent knows why it hears nothing for a while
    place = room.events.index(room.newest(MotionStarted))
    before = room.events[place - 1]
    assert (before.phase, before.permit_id) == (Phase.MOVING, "permit-1")


def test_a_status_names_the_permit_of_the_motion_whoever_else_holds(room: Room, move: BeginMove) -> None:
    room.turn(0.03)
    room.guard.handle(replace(move, permit_id="permit-2"))  # while nothing is held under it
    assert room.newest(MoveRefused).permit_id == "permit-2"
    room.while_control_is_taken = lambda: None
    begin(room, move)
    room.events.clear()
    room.turn(0.03)
    assert room.newest(Status).permit_id == "permit-1"
    assert room.newest(Status).held is True
    room.guard.handle(Heartbeat("permit-2", 1, room.challenge(), True))
    room.turn(0.03)
    assert (room.newest(Status).phase, room.newest(Status).permit_id) == (Phase.STOPPING, "permit-1")


def test_a_stop_without_a_motion_is_told_and_hinders_none_after_an_acknowledgement(room: Room, move: BeginMove) -> None:
    for _ in range(2):
        room.guard.handle(room.guard.stop_now("asked"))
    assert [one.reason for one in told(room, StopSent)] == ["asked", "asked"]
    assert room.guard.phase is Phase.HELD
    assert room.guard.severed is False
    room.guard.handle(Acknowledge())
    begin(room, move)
    assert room.guard.phase is Phase.MOVING


def test_a_stop_on_its_way_keeps_a_motion_from_starting(room: Room, move: BeginMove) -> None:
    stops = []
    room.while_control_is_taken = lambda: stops.extend([room.guard.stop_now("one"), room.guard.stop_now("two")])
    begin(room, move)
    room.guard.handle(stops[0])  # the second is not yet heard of
    room.turn()
    assert "move" not in room.orders
    assert room.newest(MoveRefused).refusal.code is RefusalCode.STOPPED


@pytest.mark.hazard("H17")
def test_a_lost_parent_ends_the_motion_for_that(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.guard.lose_parent()
    assert room.newest(StopSent).reason == "parent lost"
    assert ended(room) is EndCause.PARENT_LOST
    assert room.guard.phase is Phase.HELD


@pytest.mark.hazard("H04")
def test_a_displaced_arm_is_told_and_one_that_was_moved_on_purpose_is_not(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.reading = displaced(room.reading, 0.9)
    assert ended(room, held=False) is EndCause.HEARTBEAT_LOST
    for _ in range(40):
        room.turn()
    assert told(room, Disturbed) == []
    room.reading = displaced(room.reading, 1.5)
    for _ in range(40):
        room.turn()
    assert [one.offset_mm for one in told(room, Disturbed)] == pytest.approx([0.6])


def test_a_fault_is_told_each_time_that_it_comes_and_once(room: Room) -> None:
    for _ in range(2):
        room.reading = replace(room.reading, safety=SafetyState.PROTECTIVE_STOP)
        for _ in range(5):
            room.turn()
        assert room.guard.phase is Phase.HELD
        room.reading = replace(room.reading, safety=SafetyState.NORMAL)
        room.turn()
        room.guard.handle(Acknowledge())
        assert room.guard.phase is Phase.IDLE
    assert [one.kind for one in told(room, Fault)] == [FaultKind.PROTECTIVE_STOP] * 2


@pytest.mark.hazard("H21")
def test_a_controller_that_falls_silent_is_looked_for_once_a_second_and_heard_anew(room: Room) -> None:
    looked, read = [], room.read
    room.connect = lambda: bool(looked.append(room.now_s))
    room.read = lambda: None
    silent_since_s = room.now_s
    for _ in range(400):
        room.turn()
    assert [one.kind for one in told(room, Fault)] == [FaultKind.FEEDBACK_LOST]
    assert np.diff(looked) == pytest.approx(1.0, abs=TURN_S)
    assert looked[0] - silent_since_s <= 0.1 + 2.0 * TURN_S
    assert len(looked) == 4  # of 3.2 s
    assert room.newest(Status).connected is False
    # Switched off and on again, it counts its time from zero.
    room.read = lambda: replace(read(), controller_time_s=room.now_s - 100.0)
    room.connect = lambda: True
    room.turn(1.0)
    room.turn(0.03)
    assert room.newest(Status).connected is True


def test_lost_feedback_is_told_before_anybody_looks_for_the_controller(room: Room) -> None:
    told_before: list[tuple[bool, int]] = []

    def connect() -> bool:  # which may take seconds, and the parent hears nothing meanwhile
        told_before.append((room.newest(Status).connected, len(told(room, Fault))))
        return False

    room.connect, room.read = connect, lambda: None
    for _ in range(20):
        room.turn()
    assert told_before == [(False, 1)]


def test_a_reading_that_was_no_number_is_forgotten_with_the_connection(room: Room) -> None:
    good = room.reading
    room.reading = replace(good, tcp_speed_mm_s=np.nan)
    room.turn()
    room.read = lambda: None
    room.turn(1.1)  # connected anew
    del room.read
    room.reading = good
    room.turn(0.03)
    assert room.newest(Status).connected is True


def test_whether_a_program_runs_at_the_pendant_is_unknown_without_feedback(room: Room) -> None:
    room.reading = replace(room.reading, program_running=True)
    room.turn()
    room.read = lambda: None
    room.turn(0.2)
    room.guard.handle(ReleasePendant("access"))
    room.turn()
    assert room.newest(PendantReleased).program_running is None


def test_another_program_on_the_controller_is_no_time_for_a_motion(room: Room, move: BeginMove) -> None:
    room.reading = replace(room.reading, program_running=True)
    begin(room, move)
    refusal = room.newest(MoveRefused).refusal
    assert refusal.code is RefusalCode.ARM_NOT_READY
    assert "program" in refusal.message
    assert room.orders == []


def test_a_hold_under_another_permit_is_not_awaited(room: Room, move: BeginMove) -> None:
    def block() -> None:
        room.now_s += 0.3

    room.while_control_is_taken = block
    room.turn(0.03)
    room.beat(1)
    room.guard.handle(replace(move, permit_id="permit-1"))
    room.beat(2, held=False)
    room.turn()
    assert room.newest(MoveRefused).refusal.code is RefusalCode.NO_LIVE_HEARTBEAT
