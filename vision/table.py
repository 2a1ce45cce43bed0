"""A table of values from outside (TOML or JSON) that knows where it stands, so that every complaint names the field."""

import tomllib
from collections.abc import Mapping, Set
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

_MAX_TEXT_LENGTH = 200
_GREATEST_MAGNITUDE = 1e12  # of any number from outside; far above every quantity here, far below overflow
_MAX_TOML_BYTES = 64 * 1024


@dataclass(frozen=True, slots=True)
class Table:
    """Values by key; every accessor raises ValueError with one line where the value is missing or of another kind."""

    values: Mapping[str, Any]
    where: str

    @classmethod
    def of(cls, value: Any, where: str) -> Self:
        """`value` as a table."""
        if not isinstance(value, dict):
            raise ValueError(f"{where} must be a table")
        return cls(value, where)

    @classmethod
    def from_toml(cls, data: bytes, where: str) -> Self:
        """The top-level table of a TOML file."""
        if len(data) > _MAX_TOML_BYTES:
            raise ValueError(f"{where} is larger than {_MAX_TOML_BYTES} bytes")
        try:
            return cls(tomllib.loads(data.decode("utf-8")), where)
        except (ValueError, RecursionError) as error:  # ValueError: no UTF-8, no TOML, a number of thousands of digits
            raise ValueError(f"{where} is no TOML: {str(error).splitlines()[0]}") from error

    def __contains__(self, key: str) -> bool:
        """Whether the key is there at all."""
        return key in self.values

    def get(self, key: str) -> Any:
        """The value of whatever kind."""
        if key not in self.values:
            raise ValueError(f"{self.where}: {key} is missing")
        return self.values[key]

    def table(self, key: str) -> Self:
        """A table inside this one."""
        return type(self).of(self.get(key), f"{self.where}: {key}")

    def refuse_unknown(self, known: Set[str]) -> None:
        """ValueError for a key that is not known: a misspelt one must not count as one that was left out (H10)."""
        for unknown in sorted(self.values.keys() - known):
            raise ValueError(f"{self.where}: {unknown} is unknown; known are {', '.join(sorted(known))}")

    def text(self, key: str) -> str:
        """A text that is neither blank nor too long, of characters that can be shown."""
        value = self.get(key)
        if not isinstance(value, str) or not value.strip() or len(value) > _MAX_TEXT_LENGTH or not value.isprintable():
            raise ValueError(f"{self.where}: {key} must be a text of 1 to {_MAX_TEXT_LENGTH} printable characters")
        return value

    def integer(self, key: str, low: int, high: int) -> int:
        """A whole number from `low` to `high`."""
        value = self.get(key)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise ValueError(f"{self.where}: {key} must be a whole number from {low} to {high}")
        return value

    def number(self, key: str) -> float:
        """A finite number."""
        return _number(self.get(key), f"{self.where}: {key}")

    def numbers(self, key: str, *shape: int) -> NDArray[np.float64]:
        """Finite numbers in nested lists of the given shape."""
        flat = _flatten(self.get(key), shape, f"{self.where}: {key}")
        return np.array(flat, dtype=np.float64).reshape(shape)


def _flatten(value: Any, shape: tuple[int, ...], where: str) -> list[float]:
    if not shape:
        return [_number(value, where)]
    if not isinstance(value, list) or len(value) != shape[0]:
        raise ValueError(f"{where} must be a list of {shape[0]}")
    return [number for item in value for number in _flatten(item, shape[1:], where)]


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{where} must be a number")
    if not abs(value) <= _GREATEST_MAGNITUDE:
        raise ValueError(f"{where} must be a finite number of magnitude up to {_GREATEST_MAGNITUDE:g}")
    return float(value)
