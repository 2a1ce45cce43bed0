"""What the guard lets begin, and what it refuses before the first packet."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robot.guard.journal import EVENTS_FILE
from robot.guard.messages import Acknowledge, BeginMove, EndCause, MoveRefused, Phase
from robot.refusal import RefusalCode
from tests.robot.guarded_arm import Room, begin, ended


def ahead(move: BeginMove, offset_mm: float, turn_deg: float = 0.0) -> np.ndarray:
    goal = move.base_from_goal.copy()
    goal[0, 3] += offset_mm - 10.0  # the move's own way
    goal[:3, :3] = goal[:3, :3] @ Rotation.from_euler("x", turn_deg, degrees=True).as_matrix()
    return goal


def test_motion_goes_out_once_control_is_taken_and_everything_still_holds(room: Room, move: BeginMove) -> None:
    begin(room, move)
    assert room.orders == ["control", "move"]
    assert room.guard.phase is Phase.MOVING


def test_motion_at_every_cap_is_allowed(room: Room, move: BeginMove) -> None:
    begin(room, replace(move, speed_mm_s=20.0, acceleration_mm_s2=50.0, base_from_goal=ahead(move, 150.0, 35.0)))
    assert room.orders == ["control", "move"]


@pytest.mark.hazard("H12")
@pytest.mark.parametrize(
    ("change", "code", "limit"),
    [
        ({"speed_mm_s": 20.001}, RefusalCode.SPEED_ABOVE_CAP, 20.0),
        ({"acceleration_mm_s2": 50.001}, RefusalCode.ACCELERATION_ABOVE_CAP, 50.0),
        ({"way": (150.1, 0.0)}, RefusalCode.MOVE_TOO_FAR, 150.0),
        ({"way": (0.0, 35.1)}, RefusalCode.MOVE_TOO_FAR, np.deg2rad(35.0)),
    ],
)
def test_guard_holds_to_its_own_caps_whatever_was_planned_and_approved(
    room: Room, move: BeginMove, change: dict[str, Any], code: RefusalCode, limit: float
) -> None:
    goal = {"base_from_goal": ahead(move, *change.pop("way"))} if "way" in change else {}
    begin(room, replace(move, **change, **goal))
    refusal = room.newest(MoveRefused).refusal
    assert (refusal.code, refusal.limit) == (code, limit)
    assert refusal.measured > limit
    assert room.orders == []  # not one packet


@pytest.mark.hazard("H12")
def test_motion_against_something_that_presses_already_is_refused(room: Room, move: BeginMove) -> None:
    room.reading = replace(room.reading, tcp_force_n=np.array([0.0, 31.0, 0.0]))
    for _ in range(30):
        room.turn()
    begin(room, move)
    refusal = room.newest(MoveRefused).refusal
    assert (refusal.code, refusal.limit) == (RefusalCode.FORCE_AT_REST, 30.0)
    assert refusal.measured == pytest.approx(31.0)
    assert room.orders == []


@pytest.mark.hazard("H18")
def test_held_guard_starts_nothing_before_an_acknowledgement(room: Room, move: BeginMove) -> None:
    room.guard.handle(room.guard.stop_now("asked"))
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.GUARD_HELD
    assert "move" not in room.orders


@pytest.mark.hazard("H18")
def test_order_held_up_through_a_stop_and_an_acknowledgement_starts_nothing(room: Room, move: BeginMove) -> None:
    room.beat(1)
    room.guard.handle(room.guard.stop_now("asked"))
    room.guard.handle(Acknowledge())
    room.turn()
    room.beat(2)  # the hand never opened
    room.guard.handle(move)
    room.turn()
    assert room.newest(MoveRefused).refusal.code is RefusalCode.NO_LIVE_HEARTBEAT
    assert "move" not in room.orders


@pytest.mark.hazard("H14")
def test_second_motion_is_refused_while_one_runs_which_goes_on(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.guard.handle(replace(move, permit_id="permit-2"))
    assert room.newest(MoveRefused).refusal.code is RefusalCode.MOTION_RUNNING
    assert room.guard.phase is Phase.MOVING


@pytest.mark.hazard("H14")
def test_permit_is_spent_by_its_first_motion_whatever_came_of_it(room: Room, move: BeginMove) -> None:
    begin(room, move)
    room.guard.handle(room.guard.stop_now("asked"))
    assert ended(room) is EndCause.STOPPED
    room.guard.handle(Acknowledge())
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.PERMIT_REUSED
    assert room.orders.count("move") == 1


@pytest.mark.hazard("H24")
def test_motion_whose_intent_cannot_be_written_does_not_go_out(room: Room, move: BeginMove, tmp_path: Path) -> None:
    assert room.journal.flush(5.0)  # all before it was written
    (tmp_path / EVENTS_FILE).unlink()
    (tmp_path / EVENTS_FILE).symlink_to("/dev/full")
    begin(room, move)
    assert room.newest(MoveRefused).refusal.code is RefusalCode.JOURNAL_UNWRITABLE
    assert room.orders == []
