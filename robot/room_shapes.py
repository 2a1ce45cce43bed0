"""The room file: what the arm must keep out of, and how far (H12)."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date

import numpy as np
from scipy.spatial.transform import Rotation

from robot.frames import Array
from robot.shapes import Box, Cylinder, HalfSpace, Occupant, Shape
from robot.table import Table, expiry, number, parse_table, refuse_unknown, tables, text, vector

# Plausible ranges (H09): a metre taken for a millimetre falls outside one of them.
_CLEARANCE_MM = (2.0, 100.0)
_PLACE_MM = (0.0, 5000.0)  # from the arm's base: further away nothing matters to a UR5
_SIZE_MM = (10.0, 10000.0)  # of a solid: thinner things are drawn thicker
_TURN_DEG = (0.0, 360.0)
_UNIT = (0.99, 1.01)
# A file that forgets one of these would let the arm through it.
_DEMANDED = (Occupant.PATIENT, Occupant.TABLE, Occupant.INTENSIFIER)
_TOP = {"name", "version", "expires", "clearance_mm", "box", "cylinder", "half_space"}
_COMMON = {"name", "occupant"}


@dataclass(frozen=True, slots=True, eq=False)
class RoomShapes:
    """Keep-out shapes of a room as it stands around the arm's base.

    Attributes
    ----------
    clearance_mm : float
        How near the arm and what it carries may come to any of them: how well the shapes are known.
    sha256 : str
        Of the file's bytes.
    """

    name: str
    version: str
    expires: date | None
    sha256: str
    clearance_mm: float
    shapes: tuple[Shape, ...]


def read_room(data: bytes) -> RoomShapes:
    """Read a room file (TOML): shapes in the arm's base frame, lengths in mm.

    Raises
    ------
    ValueError
        With one line, on missing or implausible values, and where no shape stands for patient, table or intensifier.
    """
    file = parse_table(data, "room file")
    refuse_unknown(file, "the room file's", _TOP)
    shapes = tuple(read(table) for key, read in _READERS.items() for table in tables(file, key))
    if len({shape.name for shape in shapes}) < len(shapes):
        raise ValueError("two shapes have the same name")
    for occupant in _DEMANDED:
        if not any(shape.occupant is occupant for shape in shapes):
            raise ValueError(f"no shape has occupant = '{occupant}'")
    return RoomShapes(
        name=text(file, "name"),
        version=text(file, "version"),
        expires=expiry(file),
        sha256=hashlib.sha256(data).hexdigest(),
        clearance_mm=number(file, "clearance_mm", _CLEARANCE_MM),
        shapes=shapes,
    )


def _box(table: Table) -> Shape:
    refuse_unknown(table, "[[box]]", _COMMON | {"centre_mm", "size_mm", "rotation_vector_deg"})
    base_from_box = np.eye(4)
    if "rotation_vector_deg" in table:
        turn_deg = vector(table, "rotation_vector_deg", _TURN_DEG)
        base_from_box[:3, :3] = Rotation.from_rotvec(turn_deg, degrees=True).as_matrix()
    base_from_box[:3, 3] = vector(table, "centre_mm", _PLACE_MM)
    size_mm = vector(table, "size_mm", _SIZE_MM)
    if size_mm.min() < _SIZE_MM[0]:
        raise ValueError(f"size_mm has a side of {size_mm.min():g}, less than {_SIZE_MM[0]:g}")
    return Box(text(table, "name"), _occupant(table), base_from_box, size_mm / 2.0)


def _cylinder(table: Table) -> Shape:
    refuse_unknown(table, "[[cylinder]]", _COMMON | {"start_mm", "end_mm", "radius_mm"})
    start_mm, end_mm = vector(table, "start_mm", _PLACE_MM), vector(table, "end_mm", _PLACE_MM)
    if np.linalg.norm(end_mm - start_mm) < _SIZE_MM[0]:
        raise ValueError(f"start_mm and end_mm are less than {_SIZE_MM[0]:g} apart")
    return Cylinder(text(table, "name"), _occupant(table), start_mm, end_mm, number(table, "radius_mm", _SIZE_MM))


def _half_space(table: Table) -> Shape:
    refuse_unknown(table, "[[half_space]]", _COMMON | {"point_mm", "normal"})
    normal: Array = vector(table, "normal", _UNIT)
    return HalfSpace(
        text(table, "name"), _occupant(table), vector(table, "point_mm", _PLACE_MM), normal / np.linalg.norm(normal)
    )


def _occupant(table: Table) -> Occupant:
    value = text(table, "occupant")
    if value not in set(Occupant):
        raise ValueError(f"occupant '{value}' is none of {', '.join(Occupant)}")
    return Occupant(value)


_READERS: dict[str, Callable[[Table], Shape]] = {"box": _box, "cylinder": _cylinder, "half_space": _half_space}
