"""Lines between service and guard: round trips, and everything else refused."""

import dataclasses
import json

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from robot.arm import ArmState
from robot.errors import MessageError
from robot.guard.lines import decode_command, decode_event, encode, plain
from robot.guard.messages import (
    Acknowledge,
    BeginMove,
    Command,
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
    Stop,
    StopSent,
)
from robot.refusal import Refusal, RefusalCode


def events(arm: ArmState) -> list[Event]:
    refusal = Refusal(RefusalCode.TCP_MISMATCH, "µ", 0.1, None)
    return [
        Status(7, 1.0, Phase.MOVING, "abc", True, arm, "p", True, 0.05),
        Status(8, 1.0, Phase.HELD, "abc", False, None, None, False, None),
        MotionStarted("p", 2.0, np.eye(4), np.zeros(6), np.eye(4), 1.0, np.zeros(3)),
        MotionEnded("p", EndCause.MISSED, 3.0, True, True, 0.4, 0.001, arm, 2.9, "trajectory-p.jsonl", 12),
        MotionEnded("p", EndCause.FEEDBACK_LOST, 3.0, False, False, None, None, None, None, "trajectory-p.jsonl", 0),
        MoveRefused("p", 1.0, refusal),
        StopSent("asked", 1.0, False),
        PendantReleased(1.0, None),
        PendantReleased(1.0, False),
        Fault(FaultKind.GUARD_LOST, 1.0, "gone"),
        Disturbed(1.0, 0.07, 0.0),
    ]


def test_every_message_comes_back_as_it_went(move: BeginMove, reading: ArmState) -> None:
    commands: list[Command] = [
        move,
        Heartbeat("p", 3, "abc", True),
        Stop("asked"),
        ReleasePendant("access"),
        Acknowledge(),
    ]
    for command in commands:
        assert plain(decode_command(encode(command))) == plain(command)
    for event in events(reading):
        line = encode(event)
        assert line.count(b"\n") == 1
        assert len(line) < 4096  # what a pipe takes whole
        assert plain(decode_event(line)) == plain(event)


def test_every_event_is_covered_above(reading: ArmState) -> None:
    assert {type(event) for event in events(reading)} == set(Event.__args__)


@pytest.mark.hazard("H31")
@given(line=st.binary(max_size=60) | st.text(max_size=60).map(str.encode))
@example(line=b'{"type":"stop","reason":""}')  # noise that happens to be a message
def test_noise_is_refused_or_is_a_message(line: bytes) -> None:
    try:
        command = decode_command(line)
    except MessageError:
        return
    assert isinstance(command, Command)
    assert plain(decode_command(encode(command))) == plain(command)


@pytest.mark.parametrize(
    "line",
    [
        b"null",
        b"[]",
        b'{"type":"begin_move"}',
        b'{"type":"status"}',  # an event is no command
        b'{"type":"stop"}',
        b'{"type":"stop","reason":3}',
        b'{"type":"stop","reason":"x","more":1}',
        b'{"type":"heartbeat","permit_id":"p","number":1.5,"challenge":"c","held":true}',
        b'{"type":"heartbeat","permit_id":"p","number":1,"challenge":"c","held":1}',
        b'{"type":"heartbeat","permit_id":"../p","number":1,"challenge":"c","held":true}',
        b"[" * 100_000,
    ],
)
def test_message_of_the_wrong_shape_is_refused(line: bytes) -> None:
    with pytest.raises(MessageError):
        decode_command(line)


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(BeginMove) if field.name != "permit_id"])
def test_motion_with_a_number_that_is_none_is_refused(move: BeginMove, field: str) -> None:
    content = json.loads(encode(move))
    content[field] = json.loads("NaN") if isinstance(content[field], float) else _with_nan(content[field])
    with pytest.raises(MessageError):
        decode_command(json.dumps(content).encode())


def test_motion_with_a_number_that_no_float_holds_is_refused(move: BeginMove) -> None:
    content = json.loads(encode(move)) | {"speed_mm_s": 10**400}
    with pytest.raises(MessageError):
        decode_command(json.dumps(content).encode())


def _with_nan(values: list) -> list:
    broken = np.array(values)
    broken.flat[0] = np.nan
    return broken.tolist()


@pytest.mark.parametrize("field", ["speed_mm_s", "acceleration_mm_s2"])
@pytest.mark.parametrize("value", [np.nan, -1.0, 0.0, np.inf])
def test_motion_without_a_speed_is_the_callers_mistake(move: BeginMove, field: str, value: float) -> None:
    with pytest.raises(ValueError, match="speed"):
        dataclasses.replace(move, **{field: value})


NOT_NEGATIVE = (
    *("duration_s", "payload_kg", "tcp_tolerance_mm", "tcp_tolerance_rad"),
    *("payload_tolerance_kg", "payload_tolerance_mm"),
)


@pytest.mark.parametrize("field", NOT_NEGATIVE)
def test_motion_with_less_than_nothing_is_the_callers_mistake(move: BeginMove, field: str) -> None:
    for value in (-1e-9, np.inf, np.nan):
        with pytest.raises(ValueError, match="not negative"):
            dataclasses.replace(move, **{field: value})
    assert getattr(dataclasses.replace(move, **{field: 0.0}), field) == 0.0


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("permit_id", "../permit"),
        ("permit_id", "p" * 65),
        ("flange_from_guide", 2.0 * np.eye(4)),
        ("start_joints_rad", np.zeros(5)),
        ("start_joints_rad", np.array([0.0, 0.0, 0.0, 0.0, 0.0, np.inf])),
        ("payload_centre_mm", np.zeros(4)),
        ("payload_centre_mm", np.array([0.0, np.nan, 0.0])),
    ],
)
def test_motion_of_another_shape_is_the_callers_mistake(move: BeginMove, field: str, value: object) -> None:
    with pytest.raises(ValueError):
        dataclasses.replace(move, **{field: value})


def test_a_slow_motion_of_a_light_guide_is_one(move: BeginMove) -> None:
    slow = dataclasses.replace(move, speed_mm_s=0.5, acceleration_mm_s2=0.5)
    assert plain(decode_command(encode(slow))) == plain(slow)


def test_a_number_that_is_none_is_not_written() -> None:
    with pytest.raises(ValueError):
        encode(Disturbed(1.0, np.nan, 0.0))


def test_a_whole_number_is_a_number(move: BeginMove) -> None:
    """Some writers of JSON leave a decimal point out."""
    speed_mm_s = decode_command(json.dumps(json.loads(encode(move)) | {"speed_mm_s": 7}).encode()).speed_mm_s
    assert (speed_mm_s, type(speed_mm_s)) == (7.0, float)
    for other in ("7", True, None):
        with pytest.raises(MessageError):
            decode_command(json.dumps(json.loads(encode(move)) | {"speed_mm_s": other}).encode())


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity"])
def test_what_is_no_number_of_json_is_refused_even_where_none_is_expected(number: str) -> None:
    line = f'{{"type":"stop_sent","reason":{number},"at_s":1.0,"written":true}}'
    with pytest.raises(MessageError, match=f"{number} is not a number"):
        decode_event(line.encode())


def test_motion_in_metres_is_the_callers_mistake_only_if_it_is_no_transform(move: BeginMove) -> None:
    with pytest.raises(ValueError, match="proper"):
        dataclasses.replace(move, base_from_goal=move.base_from_goal * 1e-3)
