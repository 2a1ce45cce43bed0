"""What is true of the room without the product's knowing, from a TOML file."""

import math
import tomllib
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from simulator.ct.plan import PlannedCt, read_plan

DEFAULT_FILE = Path(__file__).with_name("truth.toml")


@dataclass(frozen=True, slots=True)
class ToolTruth:
    """The guide on the flange against its calibration."""

    translation_error_mm: float
    rotation_error_deg: float


@dataclass(frozen=True, slots=True)
class GuideTruth:
    """The guide against its own file."""

    ring_error_mm: float
    bead_error_mm: float
    concentricity_error_mm: float


@dataclass(frozen=True, slots=True)
class ArmErrors:
    """The arm against what its controller computes."""

    repeatability_mm: float
    kinematic_error_mm: float


@dataclass(frozen=True, slots=True)
class CarmTruth:
    """The C-arm against its dials, its file and everybody's clocks."""

    sag_mm: float
    angle_error_deg: float
    source_to_image_error_mm: float
    principal_point_error_px: float
    centring_error_mm: float
    clock_offset_s: float
    photons: float


@dataclass(frozen=True, slots=True)
class PatientTruth:
    """A patient breathes."""

    breathing_mm: float
    breathing_period_s: float


@dataclass(frozen=True, slots=True)
class HandTruth:
    """How well somebody leads the arm by eye."""

    approach_error_mm: float
    approach_error_deg: float


@dataclass(frozen=True, slots=True)
class CartTruth:
    """The arm's cart rolls a little, once."""

    settling_mm: float


@dataclass(frozen=True, slots=True)
class Truth:
    """All of it; the seed draws the directions and signs of the errors."""

    seed: int
    tool: ToolTruth
    guide: GuideTruth
    arm: ArmErrors
    carm: CarmTruth
    patient: PatientTruth
    hand: HandTruth
    cart: CartTruth
    ct: PlannedCt | None = None  # without one the patient has the procedural spine


_SECTIONS: dict[str, type] = {
    "tool": ToolTruth,
    "guide": GuideTruth,
    "arm": ArmErrors,
    "carm": CarmTruth,
    "patient": PatientTruth,
    "hand": HandTruth,
    "cart": CartTruth,
}


def read_truth(data: bytes = b"", folder: Path = Path()) -> Truth:
    """The truth of a TOML file in a folder, completed from the default file.

    Raises
    ------
    ValueError
        In one line, on unknown keys, on values that are no finite numbers, on a CT without planned paths.
    """
    defaults = tomllib.loads(DEFAULT_FILE.read_text())
    try:
        given = tomllib.loads(data.decode("utf-8"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ValueError(f"the truth is not a TOML file: {error}") from None
    planned = read_plan(given.pop("ct"), folder) if "ct" in given else None
    unknown = sorted(set(given) - set(defaults))
    if unknown:
        raise ValueError(f"the truth knows no {', '.join(unknown)}")
    sections = {name: _section(name, kind, defaults[name], given.get(name, {})) for name, kind in _SECTIONS.items()}
    return Truth(seed=_seed(given.get("seed", defaults["seed"])), **sections, ct=planned)


def _section(name: str, kind: type, defaults: dict[str, Any], given: Any) -> Any:
    if not isinstance(given, dict):
        raise ValueError(f"[{name}] of the truth is no table")
    known = [field.name for field in fields(kind)]
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise ValueError(f"[{name}] of the truth knows no {', '.join(unknown)}")
    values = defaults | given
    return kind(**{key: _number(f"{name}.{key}", values[key]) for key in known})


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{name} of the truth is no finite number")
    return float(value)


def _seed(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise ValueError("seed of the truth is no whole number from 0")
    return value
