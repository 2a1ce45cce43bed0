"""Settings, states and records as JSON values, for the pipe between a test and a controller's process."""

from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

from simulator.controller.settings import ArmTruth, ControllerSettings, Payload
from simulator.controller.state import ArmSample, ControllerState, WireRecord
from simulator.controller.states import Fault, PowerAction, RobotMode, RuntimeState, SafetyMode, WatchdogOutcome

_RECORDS = {
    kind.__name__: kind for kind in (ArmTruth, ControllerSettings, Payload, ArmSample, ControllerState, WireRecord)
}
_ENUMS = {kind.__name__: kind for kind in (Fault, PowerAction, RobotMode, RuntimeState, SafetyMode, WatchdogOutcome)}

Json = Any  # what the json module reads and writes


def to_json(value: object) -> Json:
    """A JSON value that `from_json` turns back into an equal one; a type that is not plain goes along by name.

    Raises
    ------
    TypeError
        If the value is of a type that does not cross the pipe.
    """
    match value:
        case Enum():
            return {"enum": type(value).__name__, "value": value.value}
        case None | bool() | int() | float() | str():
            return value
        case np.ndarray():
            return {"array": value.tolist()}
        case tuple():
            return [to_json(item) for item in value]
        case frozenset():
            return {"set": [to_json(item) for item in value]}
    if is_dataclass(value) and type(value).__name__ in _RECORDS:
        content = {field.name: to_json(getattr(value, field.name)) for field in fields(value)}
        return {"record": type(value).__name__, "fields": content}
    raise TypeError(f"{type(value).__name__} does not cross the pipe")


def from_json(value: Json) -> Any:
    """The value that `to_json` was given; sequences come back as tuples."""
    match value:
        case list():
            return tuple(from_json(item) for item in value)
        case {"array": items}:
            return np.array(items, dtype=np.float64)
        case {"set": items}:
            return frozenset(from_json(item) for item in items)
        case {"enum": name, "value": content}:
            return _ENUMS[name](content)
        case {"record": name, "fields": content}:
            return _RECORDS[name](**{key: from_json(item) for key, item in content.items()})
        case _:
            return value
