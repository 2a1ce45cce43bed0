"""Convex solids that the arm keeps out of, and how far a straight piece of the arm is from them."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

import numpy as np

from robot.frames import Array

# Each step keeps two thirds of a segment: after 40 a segment of 1 m is down to 1e-4 mm, and no distance changes faster
# than the point that it is measured from.
_STEPS = 40


class Occupant(StrEnum):
    """What stands where a shape is (H12)."""

    PATIENT = "patient"
    TABLE = "table"
    INTENSIFIER = "intensifier"
    OTHER = "other"


class Shape(Protocol):
    """A convex solid in the base frame."""

    @property
    def name(self) -> str: ...
    @property
    def occupant(self) -> Occupant: ...

    def distance_mm(self, points_mm: Array) -> Array:
        """Signed distance of (..., 3) points, mm: negative inside, exact, and convex along every line."""


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """A box.

    Attributes
    ----------
    base_from_box : (4, 4), mm
        Origin in its centre.
    half_mm : (3,)
        Half its sides.
    """

    name: str
    occupant: Occupant
    base_from_box: Array
    half_mm: Array

    def distance_mm(self, points_mm: Array) -> Array:
        """See `Shape`."""
        inside = (points_mm - self.base_from_box[:3, 3]) @ self.base_from_box[:3, :3]
        return _beyond(np.abs(inside) - self.half_mm)


@dataclass(frozen=True, slots=True, eq=False)
class Cylinder:
    """A round cylinder with flat ends.

    Attributes
    ----------
    start_mm, end_mm : (3,)
        Centres of its ends, base frame.
    radius_mm : float
    """

    name: str
    occupant: Occupant
    start_mm: Array
    end_mm: Array
    radius_mm: float

    def distance_mm(self, points_mm: Array) -> Array:
        """See `Shape`."""
        half_mm = float(np.linalg.norm(self.end_mm - self.start_mm)) / 2.0
        axis = (self.end_mm - self.start_mm) / (2.0 * half_mm)
        from_middle = points_mm - (self.start_mm + self.end_mm) / 2.0
        along = from_middle @ axis
        aside = np.linalg.norm(from_middle - along[..., None] * axis, axis=-1)
        return _beyond(np.stack([aside - self.radius_mm, np.abs(along) - half_mm], axis=-1))


@dataclass(frozen=True, slots=True, eq=False)
class HalfSpace:
    """Everything behind a plane.

    Attributes
    ----------
    point_mm, normal : (3,)
        A point of the plane, and the unit normal towards the free side; base frame.
    """

    name: str
    occupant: Occupant
    point_mm: Array
    normal: Array

    def distance_mm(self, points_mm: Array) -> Array:
        """See `Shape`."""
        return np.asarray((points_mm - self.point_mm) @ self.normal)


def segment_distance(shape: Shape, starts_mm: Array, ends_mm: Array) -> Array:
    """Smallest signed distance of straight segments from a shape.

    Parameters
    ----------
    starts_mm, ends_mm : (..., 3)
        Base frame.

    Returns
    -------
    (...), mm
        Exact to 1e-4 mm for segments of up to a metre.

    Notes
    -----
    The signed distance from a convex solid is convex along a line, so its minimum is found by thirds.
    """
    low, high = np.zeros(starts_mm.shape[:-1]), np.ones(starts_mm.shape[:-1])
    way_mm = ends_mm - starts_mm

    def distance(shares: Array) -> Array:
        return shape.distance_mm(starts_mm + shares[..., None] * way_mm)

    for _ in range(_STEPS):
        third = (high - low) / 3.0
        left = distance(low + third) <= distance(high - third)
        low, high = np.where(left, low, low + third), np.where(left, high - third, high)
    return distance((low + high) / 2.0)


def _beyond(excess_mm: Array) -> Array:
    """Signed distance from (..., n) excesses over a solid's extents along perpendicular directions."""
    outside = np.linalg.norm(np.maximum(excess_mm, 0.0), axis=-1)
    return np.asarray(outside + np.minimum(excess_mm.max(axis=-1), 0.0))
