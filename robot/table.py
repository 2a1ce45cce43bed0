"""Values of a device file (TOML): present, of the right kind, and plausible (H09)."""

import tomllib
from collections.abc import Mapping
from datetime import date
from typing import Any

import numpy as np

from robot.frames import Array

Table = Mapping[str, Any]
Range = tuple[float, float]

_MOST_BYTES = 64 * 1024  # of a file: a room of a hundred shapes takes a quarter of it


def parse_table(data: bytes, what: str) -> Table:
    """A whole file; ValueError in one line that says what it is not."""
    if len(data) > _MOST_BYTES:
        raise ValueError(f"the {what} is larger than {_MOST_BYTES} bytes")
    try:
        return tomllib.loads(data.decode("utf-8"))
    except (ValueError, RecursionError) as error:  # ValueError: no UTF-8, no TOML, a number of thousands of digits
        raise ValueError(f"the {what} is not a TOML file: {error}") from None


def subtable(file: Table, key: str) -> Table:
    """A table of the file."""
    value = file.get(key)
    if not isinstance(value, dict):
        raise ValueError(f"[{key}] is missing")
    return value


def tables(file: Table, key: str) -> list[Table]:
    """All tables of one name, none if there are none."""
    value = file.get(key, [])
    if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
        raise ValueError(f"{key} is not written as [[{key}]]")
    return value


def refuse_unknown(table: Table, where: str, known: set[str]) -> None:
    """ValueError for a key that is not known: a misspelt one must not fall back to a default."""
    for unknown in sorted(set(table) - known):
        raise ValueError(f"{where} {unknown} is unknown; known are {', '.join(sorted(known))}")


def text(table: Table, key: str) -> str:
    """A text that is not empty, of characters that can be shown."""
    value = table.get(key)
    if not isinstance(value, str) or not value.strip():
        raise ValueError(f"{key} is missing")
    if not value.isprintable():
        raise ValueError(f"{key} holds characters that cannot be shown")
    return value


def expiry(file: Table) -> date | None:
    """The file's last day of use, if it has one."""
    value = file.get("expires")
    if value is not None and type(value) is not date:
        raise ValueError("expires is not a date")
    return value


def number(table: Table, key: str, allowed: Range, default: float | None = None) -> float:
    """A number within its plausible range."""
    value = table.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{key} is missing or not a number")
    return float(_plausible(key, value, allowed))


def vector(table: Table, key: str, allowed: Range) -> Array:
    """Three numbers, (3,), as a vector of plausible length."""
    value = table.get(key)
    numbers = isinstance(value, list) and all(type(item) in (int, float) for item in value)
    if not numbers or len(value or ()) != 3:
        raise ValueError(f"{key} is missing or not three numbers")
    lowest, highest = allowed
    found = np.array([_plausible(f"each number of {key}", item, (-highest, highest)) for item in value or ()])
    _plausible(f"the length of {key}", float(np.linalg.norm(found)), (lowest, highest))
    return found


def _plausible(name: str, value: float, allowed: Range) -> float:
    """The value, unless it is not between the two; a whole number may be too large to become a float."""
    lowest, highest = allowed
    if not lowest <= value <= highest:
        raise ValueError(f"{name} is {value}, not between {lowest:g} and {highest:g}")
    return value
