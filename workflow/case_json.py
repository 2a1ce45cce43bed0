"""A case as JSON and back, so that the service can rebuild it from its last event."""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from types import UnionType
from typing import Any, get_args, get_origin, get_type_hints

from workflow.case import CaseState


def to_json(case: CaseState) -> dict[str, Any]:
    """The case as a dict of strings, numbers, lists and dicts."""
    return _fields_of(case)


def from_json(data: dict[str, Any]) -> CaseState:
    """The case that `to_json` wrote.

    Raises
    ------
    ValueError
        If a field without a default is missing, or one is unknown or of another type.
    """
    case: CaseState = _read(CaseState, data, "case")
    return case


@dataclass(frozen=True, slots=True)
class _Shape:
    """What the fields of a dataclass hold: looked up once, for Python evaluates the annotations at every look."""

    kinds: Mapping[str, Any]
    since: frozenset[str]  # what a record does not have that was written before there was such a field


@cache
def _shape(kind: Any) -> _Shape:
    hints = get_type_hints(kind)
    since = frozenset(field.name for field in fields(kind) if field.default is not MISSING)
    return _Shape({field.name: hints[field.name] for field in fields(kind)}, since)


def _plain(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return _fields_of(value) if is_dataclass(value) else value


def _fields_of(one: Any) -> dict[str, Any]:
    return {name: _plain(getattr(one, name)) for name in _shape(one.__class__).kinds}


def _read(kind: Any, value: Any, where: str) -> Any:
    if get_origin(kind) is UnionType:
        options = [option for option in get_args(kind) if option is not type(None)]
        return None if value is None else _read(options[0], value, where)
    if get_origin(kind) is tuple:
        return tuple(_read(get_args(kind)[0], item, where) for item in _checked(value, list, where))
    if is_dataclass(kind):
        return _read_fields(kind, _checked(value, dict, where), where)
    if issubclass(kind, Enum):
        return kind(value)
    return float(_checked(value, (int, float), where)) if kind is float else _checked(value, kind, where)


def _read_fields(kind: Any, data: dict[str, Any], where: str) -> Any:
    shape = _shape(kind)
    if wrong := (shape.kinds.keys() ^ data.keys()) - shape.since:
        raise ValueError(f"{where}: fields {sorted(wrong)} are missing or unknown")
    told = ((name, one) for name, one in shape.kinds.items() if name in data)
    return kind(**{name: _read(one, data[name], f"{where}.{name}") for name, one in told})


def _checked(value: Any, kind: Any, where: str) -> Any:
    # A bool is an int to Python, but not to whoever wrote the record.
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        raise ValueError(f"{where}: {value!r} is of another type")
    return value
