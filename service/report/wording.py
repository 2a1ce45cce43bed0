"""Figures, times and missing facts as the report words them: one place for units and digits."""

import math
from collections.abc import Sequence
from datetime import UTC, datetime

from pydicom.valuerep import PersonName

NOT_TOLD = "not told"
NOTHING = "–"
MINUS = "\N{MINUS SIGN}"
# The 95 % bounds are some hundredths of a degree and tenths of a millimetre: further digits would say nothing.
_DECIMALS = 2
_UNITS = {"rad": "°", "rad/s": "°/s", "mm/s2": "mm/s²"}
_IN_DEGREES = ("rad", "rad/s")
_SPELLED = {"carm": "C-arm", "tcp": "TCP", "pin": "PIN"}


def figure(value: float | None, unit: str = "", decimals: int = _DECIMALS) -> str:
    """A number with its unit; a dash where there is none."""
    if value is None:
        return NOTHING
    return _with_unit(f"{value:.{decimals}f}", unit)


def measured(value: float | str | bool | None, unit: str) -> str:
    """What an interlock measured or was limited to, angles in degrees."""
    match value:
        case None:
            return "unknown"
        case bool():
            return "yes" if value else "no"
        case int() | float():
            return _with_unit(_magnitude(value, unit), _UNITS.get(unit, unit))
        case _:
            return str(value)


def measured_range(values: Sequence[float], unit: str) -> str:
    """The smallest and the largest that an interlock measured."""
    low, high = _magnitude(min(values), unit), _magnitude(max(values), unit)
    return _with_unit(low if low == high else f"{low} to {high}", _UNITS.get(unit, unit))


def _magnitude(value: float, unit: str) -> str:
    """Three digits that count, but no thousandths' parts: the ranges of interlocks differ by orders."""
    shown = round(math.degrees(value) if unit in _IN_DEGREES else value, 3)
    return f"{shown:.3g}" if abs(shown) < 1000.0 else f"{shown:.0f}"


def _with_unit(number: str, unit: str) -> str:
    """No space before the degree sign (ISO 80000-1, 7.1.4)."""
    apart = "" if unit.startswith("°") or not unit else "\N{NO-BREAK SPACE}"
    return f"{number.replace('-', MINUS)}{apart}{unit}"


def moment(at: str) -> str:
    """A recorded time to the second, UTC."""
    return _time(at).strftime("%Y-%m-%d %H:%M:%S")


def clock(at: str) -> str:
    """The time of day alone."""
    return _time(at).strftime("%H:%M:%S")


def seconds_between(start: str, end: str) -> float | None:
    """None where the clock was set back between the two, so that nobody knows (H23)."""
    seconds = (_time(end) - _time(start)).total_seconds()
    return seconds if seconds >= 0.0 else None


def lasted(seconds: float | None) -> str:
    """A duration in minutes and seconds; unknown where the clock was set back meanwhile."""
    if seconds is None:
        return "unknown"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02d}\N{NO-BREAK SPACE}min"


def person_name(name: PersonName | str | None) -> str:
    """A patient's name in every writing that DICOM gives (PS3.5 6.2.1): the parts apart, other writings in brackets."""
    if not name:
        return NOT_TOLD
    writings = [" ".join(part for part in group.split("^") if part) for group in str(name).split("=")]
    first, *others = [one for one in writings if one] or [NOT_TOLD]
    return f"{first} ({', '.join(others)})" if others else first


def words(code: str) -> str:
    """A code of the record as words."""
    return " ".join(_SPELLED.get(word, word) for word in code.split("_"))


def _time(at: str) -> datetime:
    return datetime.fromisoformat(at).astimezone(UTC)
