"""The guide and the C-arm as their TOML files describe them, each value held to a plausibility range (H09).

Every range spans less than a factor of 57: a length written in metres (x 1000) and an angle in the wrong unit
(x 57.3) fall outside, whatever the right value was.
"""

import hashlib
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date, datetime
from enum import StrEnum
from typing import Any, Self

_MAX_FILE_BYTES = 64 * 1024
_MAX_NAME_LENGTH = 200


@dataclass(frozen=True, slots=True)
class Range:
    """Least and greatest plausible value of a field, in the field's unit."""

    low: float
    high: float

    def check(self, value: float, where: str) -> float:
        """`value` as a float; ValueError naming `where` unless it is finite and inside."""
        if not (math.isfinite(value) and self.low <= value <= self.high):
            raise ValueError(f"{where} = {value:g} is outside the plausible range {self.low:g} to {self.high:g}")
        return float(value)


_RING_RADIUS_MM = Range(5.0, 150.0)
_SEPARATION_MM = Range(15.0, 300.0)
_LINE_MM = Range(5.0, 200.0)
_WIRE_DIAMETER_MM = Range(0.2, 5.0)
_BEAD_DIAMETER_MM = Range(0.5, 12.0)
_BEAD_COORDINATE_MM = Range(1.0, 200.0)  # magnitude; a coordinate below 1 mm must be 0, else it is a slip of unit
_MANUFACTURE_SD_MM = Range(0.005, 0.25)
_SOURCE_TO_IMAGE_MM = Range(500.0, 2000.0)
_SOURCE_TO_IMAGE_SD_MM = Range(2.0, 100.0)
_PRINCIPAL_POINT_SD_PX = Range(1.0, 50.0)
_FIELD_OF_VIEW_MM = Range(100.0, 600.0)
_BALL_SPACING_MM = Range(5.0, 50.0)
_BALL_DIAMETER_MM = Range(0.5, 10.0)


class DetectorKind(StrEnum):
    """What turns X-rays into pixels; only an intensifier distorts and needs a plate."""

    INTENSIFIER = "image-intensifier"
    FLAT_PANEL = "flat-panel"


@dataclass(frozen=True, slots=True)
class Bead:
    """The ball that breaks the mirror symmetry; position in the guide frame."""

    position_mm: tuple[float, float, float]
    diameter_mm: float


@dataclass(frozen=True, slots=True)
class GuideTolerance:
    """Standard deviations of manufacture."""

    radius_sd_mm: float
    separation_sd_mm: float
    bead_sd_mm: float
    bore_concentricity_sd_mm: float


@dataclass(frozen=True, slots=True)
class Guide:
    """Two coaxial wire rings (small in z = 0, big in z = -separation), a line along +x in z = 0, and mostly a bead."""

    name: str
    version: int
    sha256: str
    expires: date | None
    small_ring_radius_mm: float
    big_ring_radius_mm: float
    separation_mm: float
    line_start_mm: float
    line_end_mm: float
    wire_diameter_mm: float
    bead: Bead | None
    tolerance: GuideTolerance


@dataclass(frozen=True, slots=True)
class Plate:
    """The correction plate on an intensifier: a square lattice of balls."""

    ball_spacing_mm: float
    ball_diameter_mm: float


@dataclass(frozen=True, slots=True)
class CArm:
    """What is known of a C-arm beforehand: nominal geometry with its priors, the detector, and the plate if any."""

    name: str
    version: int
    sha256: str
    expires: date | None
    source_to_image_mm: float
    source_to_image_sd_mm: float
    principal_point_sd_px: float
    detector: DetectorKind
    field_of_view_mm: float
    plate: Plate | None


def read_guide(data: bytes) -> Guide:
    """The guide described by a TOML file; ValueError with one clear line if anything is missing or implausible."""
    raise NotImplementedError


def read_carm(data: bytes) -> CArm:
    """The C-arm described by a TOML file; ValueError with one clear line if anything is missing or implausible."""
    raise NotImplementedError
