"""The guide and the C-arm as their TOML files describe them, each value held to a plausibility range (H09).

Every range spans less than a factor of 57: a length written in metres (x 1000) and a value in the wrong angle unit
(x 57.3) fall outside, whatever the right value was.
"""

import hashlib
from dataclasses import dataclass
from datetime import date, datetime
from enum import StrEnum
from functools import cache
from typing import Annotated, Any, get_type_hints

from vision.table import Table

_RINGS_AND_LINE = {"small_ring", "big_ring", "axis", "indicator_line", "wire"}
_GUIDE_KEYS = _RINGS_AND_LINE | {"name", "version", "expires", "bead", "tolerance"}
_CARM_KEYS = {"name", "version", "expires", "geometry", "detector", "plate"}
_LARGEST_VERSION = 1_000_000
_LEAST_COORDINATE_MM = 1.0  # of the bead; a smaller one is either 0 or a slip of unit
_GREATEST_COORDINATE_MM = 200.0


@dataclass(frozen=True, slots=True)
class Plausible:
    """Least and greatest plausible value of the field it annotates, in the unit that the field's name states."""

    low: float
    high: float


@cache
def _limits(kind: Any) -> tuple[tuple[str, Plausible], ...]:
    """Fields of a class that have a plausible range; a fit makes thousands of guides of slightly other dimensions."""
    hints = get_type_hints(kind, include_extras=True).items()
    return tuple((name, limit) for name, hint in hints for limit in getattr(hint, "__metadata__", ()))


def _check_ranges(device: Any) -> None:
    """ValueError naming the first field outside its plausible range."""
    kind: Any = type(device)
    for name, limit in _limits(kind):
        value = getattr(device, name)
        if not limit.low <= value <= limit.high:
            limits = f"the plausible {limit.low:g} to {limit.high:g}"
            raise ValueError(f"{kind.__name__}: {name} = {value:g} is outside {limits}")


class DetectorKind(StrEnum):
    """What turns X-rays into pixels; only an intensifier distorts and needs a plate."""

    INTENSIFIER = "image-intensifier"
    FLAT_PANEL = "flat-panel"


@dataclass(frozen=True, slots=True)
class Bead:
    """The ball that breaks the mirror symmetry; position in the guide frame."""

    position_mm: tuple[float, float, float]
    diameter_mm: Annotated[float, Plausible(0.5, 12.0)]

    def __post_init__(self) -> None:
        """Hold every value to its plausible range."""
        _check_ranges(self)
        for coordinate in self.position_mm:
            if coordinate != 0.0 and not _LEAST_COORDINATE_MM <= abs(coordinate) <= _GREATEST_COORDINATE_MM:
                raise ValueError(f"Bead: position_mm holds {coordinate:g}, neither 0 nor plausible (1 to 200)")
        if self.position_mm[1] == 0.0:
            raise ValueError("Bead: position_mm has y = 0; in the plane of symmetry it tells no mirror image")


@dataclass(frozen=True, slots=True)
class GuideTolerance:
    """Standard deviations of manufacture; the bore's is of its offset at the big ring against the small one."""

    radius_sd_mm: Annotated[float, Plausible(0.005, 0.25)]
    separation_sd_mm: Annotated[float, Plausible(0.005, 0.25)]
    bead_sd_mm: Annotated[float, Plausible(0.01, 0.5)]
    bore_concentricity_sd_mm: Annotated[float, Plausible(0.005, 0.25)]

    def __post_init__(self) -> None:
        """Hold every value to its plausible range."""
        _check_ranges(self)


@dataclass(frozen=True, slots=True)
class Guide:
    """Two coaxial wire rings (small in z = 0, big in z = -separation), a line along +x in z = 0, and mostly a bead.

    `expires` is the last day on which the file may be used.
    """

    name: str
    version: int
    sha256: str
    expires: date | None
    small_ring_radius_mm: Annotated[float, Plausible(5.0, 150.0)]
    big_ring_radius_mm: Annotated[float, Plausible(5.0, 150.0)]
    separation_mm: Annotated[float, Plausible(15.0, 300.0)]
    line_start_mm: Annotated[float, Plausible(5.0, 200.0)]
    line_end_mm: Annotated[float, Plausible(5.0, 200.0)]
    wire_diameter_mm: Annotated[float, Plausible(0.2, 5.0)]
    bead: Bead | None
    tolerance: GuideTolerance

    def __post_init__(self) -> None:
        """Hold every value to its plausible range, and the values to one another."""
        _check_ranges(self)
        if self.small_ring_radius_mm >= self.big_ring_radius_mm:
            raise ValueError("Guide: small_ring_radius_mm must be below big_ring_radius_mm")
        if self.line_start_mm >= self.line_end_mm:
            raise ValueError("Guide: line_start_mm must be below line_end_mm")


@dataclass(frozen=True, slots=True)
class Plate:
    """The correction plate on an intensifier: a square lattice of balls."""

    ball_spacing_mm: Annotated[float, Plausible(5.0, 50.0)]
    ball_diameter_mm: Annotated[float, Plausible(0.5, 10.0)]

    def __post_init__(self) -> None:
        """Hold every value to its plausible range, and the values to one another."""
        _check_ranges(self)
        if 2.0 * self.ball_diameter_mm > self.ball_spacing_mm:
            raise ValueError("Plate: ball_diameter_mm must be at most half of ball_spacing_mm")


@dataclass(frozen=True, slots=True)
class CArm:
    """What is known of a C-arm beforehand: nominal geometry with its priors, the detector, and the plate if any.

    `expires` is the last day on which the file may be used.
    """

    name: str
    version: int
    sha256: str
    expires: date | None
    source_to_image_mm: Annotated[float, Plausible(500.0, 2000.0)]
    source_to_image_sd_mm: Annotated[float, Plausible(2.0, 100.0)]
    principal_point_sd_px: Annotated[float, Plausible(1.0, 50.0)]
    detector: DetectorKind
    field_of_view_mm: Annotated[float, Plausible(100.0, 600.0)]
    plate: Plate | None

    def __post_init__(self) -> None:
        """Hold every value to its plausible range; an intensifier has a plate, a flat panel none."""
        _check_ranges(self)
        if (self.plate is None) != (self.detector is DetectorKind.FLAT_PANEL):
            raise ValueError("CArm: an image intensifier needs a plate, a flat panel has none")


def read_guide(data: bytes) -> Guide:
    """The guide described by a TOML file; ValueError with one clear line if anything is missing or implausible."""
    top = Table.from_toml(data, "guide file")
    top.refuse_unknown(_GUIDE_KEYS)
    tolerance = top.table("tolerance")
    return Guide(
        name=top.text("name"),
        version=top.integer("version", 1, _LARGEST_VERSION),
        sha256=hashlib.sha256(data).hexdigest(),
        expires=_expires(top),
        small_ring_radius_mm=top.table("small_ring").number("radius"),
        big_ring_radius_mm=top.table("big_ring").number("radius"),
        separation_mm=top.table("axis").number("separation"),
        line_start_mm=top.table("indicator_line").number("start"),
        line_end_mm=top.table("indicator_line").number("end"),
        wire_diameter_mm=top.table("wire").number("diameter"),
        bead=_bead(top.table("bead")) if "bead" in top else None,
        tolerance=GuideTolerance(
            radius_sd_mm=tolerance.number("radius_sd"),
            separation_sd_mm=tolerance.number("separation_sd"),
            bead_sd_mm=tolerance.number("bead_sd"),
            bore_concentricity_sd_mm=tolerance.number("bore_concentricity_sd"),
        ),
    )


def _bead(table: Table) -> Bead:
    x_mm, y_mm, z_mm = map(float, table.numbers("position", 3))
    return Bead(position_mm=(x_mm, y_mm, z_mm), diameter_mm=table.number("diameter"))


def read_carm(data: bytes) -> CArm:
    """The C-arm described by a TOML file; ValueError with one clear line if anything is missing or implausible."""
    top = Table.from_toml(data, "C-arm file")
    top.refuse_unknown(_CARM_KEYS)
    geometry, detector = top.table("geometry"), top.table("detector")
    return CArm(
        name=top.text("name"),
        version=top.integer("version", 1, _LARGEST_VERSION),
        sha256=hashlib.sha256(data).hexdigest(),
        expires=_expires(top),
        source_to_image_mm=geometry.number("source_to_image_distance"),
        source_to_image_sd_mm=geometry.number("source_to_image_distance_sd"),
        principal_point_sd_px=geometry.number("principal_point_sd_px"),
        detector=_detector_kind(detector),
        field_of_view_mm=detector.number("field_of_view"),
        plate=_plate(top.table("plate")) if "plate" in top else None,
    )


def _plate(table: Table) -> Plate:
    return Plate(ball_spacing_mm=table.number("ball_spacing"), ball_diameter_mm=table.number("ball_diameter"))


def _detector_kind(detector: Table) -> DetectorKind:
    kind = detector.text("kind")
    if kind not in tuple(DetectorKind):
        raise ValueError(f"{detector.where}: kind must be one of {', '.join(DetectorKind)}")
    return DetectorKind(kind)


def _expires(top: Table) -> date | None:
    expires = top.values.get("expires")
    if expires is not None and (isinstance(expires, datetime) or not isinstance(expires, date)):
        raise ValueError(f"{top.where}: expires must be a date, as in 2027-12-31")
    return expires
