"""Messages to lines and back: JSON with the message's name under `type`, arrays as nested lists."""

import dataclasses
import json
from collections.abc import Hashable, Mapping
from enum import StrEnum
from functools import cache
from types import NoneType, UnionType
from typing import Any, NoReturn, TypeVar, cast, get_args, get_origin, get_type_hints

import numpy as np

from robot.errors import MessageError
from robot.guard.messages import (
    Acknowledge,
    BeginMove,
    Command,
    Disturbed,
    Event,
    Fault,
    Heartbeat,
    MotionEnded,
    MotionStarted,
    MoveRefused,
    PendantReleased,
    ReleasePendant,
    Status,
    Stop,
    StopSent,
)

_Message = TypeVar("_Message")
_COMMANDS: dict[str, type[Command]] = {
    "begin_move": BeginMove,
    "heartbeat": Heartbeat,
    "stop": Stop,
    "release_pendant": ReleasePendant,
    "acknowledge": Acknowledge,
}
_EVENTS: dict[str, type[Event]] = {
    "status": Status,
    "motion_started": MotionStarted,
    "motion_ended": MotionEnded,
    "move_refused": MoveRefused,
    "stop_sent": StopSent,
    "pendant_released": PendantReleased,
    "fault": Fault,
    "disturbed": Disturbed,
}
_NAMES: dict[type, str] = {kind: name for name, kind in (*_COMMANDS.items(), *_EVENTS.items())}


def encode(message: Command | Event) -> bytes:
    """One line, ended by a newline; ValueError if a number is not finite."""
    content = {"type": _NAMES[type(message)], **plain(message)}
    return json.dumps(content, separators=(",", ":"), allow_nan=False).encode() + b"\n"


def decode_command(line: bytes) -> Command:
    """A command from a line; MessageError if it is none."""
    return _decode(line, _COMMANDS)


def decode_event(line: bytes) -> Event:
    """An event from a line; MessageError if it is none."""
    return _decode(line, _EVENTS)


def plain(value: Any) -> Any:
    """A message, or a part of one, as JSON knows it."""
    if dataclasses.is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    return value.tolist() if isinstance(value, np.ndarray) else value


def _decode(line: bytes, kinds: Mapping[str, type[_Message]]) -> _Message:
    try:
        content = json.loads(line, parse_constant=_refuse_constant)
        return _build(kinds[content.pop("type")], content)
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        raise MessageError(f"not a message of the guard: {error!r}") from None


def _build(kind: type[_Message], content: Mapping[str, Any]) -> _Message:
    hints = _hints(cast(Hashable, kind))
    if content.keys() != hints.keys():
        raise ValueError(f"{kind.__name__} has the fields {', '.join(hints)}")
    return kind(**{name: _convert(hint, content[name]) for name, hint in hints.items()})


def _convert(hint: Any, value: Any) -> Any:
    """A JSON value as the type that a field declares; ValueError or TypeError if it is none."""
    if isinstance(hint, UnionType):
        declared = next(item for item in get_args(hint) if item is not NoneType)
        return None if value is None else _convert(declared, value)
    if get_origin(hint) is np.ndarray:
        return np.array(value, dtype=np.float64)
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        return _build(hint, value)
    if issubclass(hint, StrEnum):
        return hint(value)
    if hint is float and type(value) is int:
        return float(value)
    if type(value) is not hint:
        raise TypeError(f"{value!r} is not of type {hint.__name__}")
    return value


@cache
def _hints(kind: Hashable) -> dict[str, Any]:
    return get_type_hints(kind)


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a number")
