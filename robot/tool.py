"""The TCP calibration file: where the guide is on the flange, and what it weighs."""

import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from robot.frames import Array, Transform


@dataclass(frozen=True, slots=True, eq=False)
class Tool:
    """A calibrated tool.

    Attributes
    ----------
    flange_from_guide : (4, 4), mm
        The TCP that the controller must have active.
    payload_centre_mm : (3,)
        Centre of mass in the flange frame.
    tcp_tolerance_mm, tcp_tolerance_rad, payload_tolerance_kg, payload_tolerance_mm : float
        How far the controller's values may be from these (H10).
    sha256 : str
        Of the file's bytes.
    """

    name: str
    version: str
    expires: date | None
    sha256: str
    flange_from_guide: Transform
    payload_kg: float
    payload_centre_mm: Array
    tcp_tolerance_mm: float
    tcp_tolerance_rad: float
    payload_tolerance_kg: float
    payload_tolerance_mm: float


# Plausible ranges (H09): a metre taken for a millimetre, or a radian for a degree, falls outside one of them.
_TCP_MM = (20.0, 600.0)  # of the offset's length: the guide stands off the flange, within an arm's tool
_TURN_DEG = (0.0, 360.0)  # of the rotation vector's length
_MASS_KG = (0.05, 5.0)  # a UR5 carries 5 kg
_CENTRE_MM = (0.0, 300.0)
_TOLERANCES = {
    "tcp_mm": (0.05, (0.001, 1.0)),
    "tcp_deg": (0.02, (0.001, 1.0)),
    "mass_kg": (0.05, (0.001, 1.0)),
    "centre_mm": (5.0, (0.1, 50.0)),
}


def read_tool(data: bytes) -> Tool:
    """Read a TCP calibration file (TOML).

    Raises
    ------
    ValueError
        With one line, on missing or implausible values (H09).
    """
    file = _parse(data)
    tcp, payload = _table(file, "tcp"), _table(file, "payload")
    given = _table(file, "tolerance") if "tolerance" in file else {}
    for unknown in sorted(set(given) - set(_TOLERANCES)):
        raise ValueError(f"[tolerance] {unknown} is unknown: a misspelt tolerance must not fall back to its default")
    tolerance = {name: _number(given, name, allowed, default) for name, (default, allowed) in _TOLERANCES.items()}
    return Tool(
        name=_text(file, "name"),
        version=_text(file, "version"),
        expires=_expiry(file),
        sha256=hashlib.sha256(data).hexdigest(),
        flange_from_guide=_transform(tcp),
        payload_kg=_number(payload, "mass_kg", _MASS_KG),
        payload_centre_mm=_vector(payload, "centre_mm", _CENTRE_MM),
        tcp_tolerance_mm=tolerance["tcp_mm"],
        tcp_tolerance_rad=float(np.deg2rad(tolerance["tcp_deg"])),
        payload_tolerance_kg=tolerance["mass_kg"],
        payload_tolerance_mm=tolerance["centre_mm"],
    )


def _parse(data: bytes) -> dict[str, Any]:
    try:
        return tomllib.loads(data.decode("utf-8"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ValueError(f"the TCP calibration is not a TOML file: {error}") from None


def _transform(tcp: Mapping[str, Any]) -> Transform:
    flange_from_guide = np.eye(4)
    turn_deg = _vector(tcp, "rotation_vector_deg", _TURN_DEG)
    flange_from_guide[:3, :3] = Rotation.from_rotvec(turn_deg, degrees=True).as_matrix()
    flange_from_guide[:3, 3] = _vector(tcp, "translation_mm", _TCP_MM)
    return flange_from_guide


def _table(file: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = file.get(key)
    if not isinstance(value, dict):
        raise ValueError(f"[{key}] is missing")
    return value


def _text(file: Mapping[str, Any], key: str) -> str:
    value = file.get(key)
    if not isinstance(value, str) or not value.strip():
        raise ValueError(f"{key} is missing")
    return value


def _expiry(file: Mapping[str, Any]) -> date | None:
    value = file.get("expires")
    if value is not None and type(value) is not date:
        raise ValueError("expires is not a date")
    return value


def _number(table: Mapping[str, Any], key: str, allowed: tuple[float, float], default: float | None = None) -> float:
    value = table.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{key} is missing or not a number")
    return _plausible(key, float(value), allowed)


def _vector(table: Mapping[str, Any], key: str, allowed: tuple[float, float]) -> Array:
    value = table.get(key)
    numbers = isinstance(value, list) and all(type(item) in (int, float) for item in value)
    if not numbers or len(value or ()) != 3:
        raise ValueError(f"{key} is missing or not three numbers")
    vector = np.array(value, dtype=np.float64)
    _plausible(f"the length of {key}", float(np.linalg.norm(vector)), allowed)
    return vector


def _plausible(name: str, value: float, allowed: tuple[float, float]) -> float:
    lowest, highest = allowed
    if not lowest <= value <= highest:
        raise ValueError(f"{name} is {value:g}, not between {lowest:g} and {highest:g}")
    return value
