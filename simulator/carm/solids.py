"""Bodies of which a patient is made: ellipsoids, elliptic cylinders and boxes with an attenuation of their own."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

_LEAST = np.float32(1e-9)


class Shape(StrEnum):
    """Which bound a solid has along its axes; a cylinder's axis is its z."""

    ELLIPSOID = "ellipsoid"
    CYLINDER = "cylinder"
    BOX = "box"


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """Attenuation `per_mm` added within half axes `half_mm` about a centre; negative ones carve a hollow."""

    shape: Shape
    centre_mm: tuple[float, float, float]
    half_mm: tuple[float, float, float]
    per_mm: float
    patient_from_solid: Array = field(default_factory=lambda: np.eye(3))  # rotation

    @property
    def reach_mm(self) -> float:
        """Radius of the ball around the centre that holds the solid."""
        stretch = {Shape.ELLIPSOID: 1.0, Shape.CYLINDER: 1.42, Shape.BOX: 1.74}[self.shape]
        return stretch * max(self.half_mm)

    def holds(self, points: Array32) -> NDArray[np.bool_]:
        """Whether points (..., 3), patient frame, are inside: (...)."""
        to_unit = self.patient_from_solid / np.array(self.half_mm)
        unit = np.abs((points - np.array(self.centre_mm, dtype=np.float32)) @ to_unit.astype(np.float32))
        match self.shape:
            case Shape.ELLIPSOID:
                inside = np.einsum("...i,...i->...", unit, unit) <= 1.0
            case Shape.CYLINDER:
                inside = (np.hypot(unit[..., 0], unit[..., 1]) <= 1.0) & (unit[..., 2] <= 1.0)
            case Shape.BOX:
                inside = unit.max(axis=-1) <= 1.0
        held: NDArray[np.bool_] = inside
        return held

    def depths(self, origin: Array, rays: Array32) -> Array32:
        """Optical depth (...) along rays from one origin (3,), unit directions (..., 3), patient frame."""
        to_unit = self.patient_from_solid / np.array(self.half_mm)
        start = ((origin - np.array(self.centre_mm)) @ to_unit).astype(np.float32)
        steps = rays @ to_unit.astype(np.float32)
        match self.shape:
            case Shape.ELLIPSOID:
                entry, leave = _round(start, steps)
            case Shape.CYLINDER:
                entry, leave = _slab(start, steps, 2, *_round(start[:2], steps[..., :2]))
            case Shape.BOX:
                leave = np.full(rays.shape[:-1], np.inf, dtype=np.float32)
                entry = -leave
                for axis in range(3):
                    entry, leave = _slab(start, steps, axis, entry, leave)
        depths: Array32 = np.float32(self.per_mm) * np.maximum(leave - entry, np.float32(0.0))
        return depths


def _round(start: Array32, steps: Array32) -> tuple[Array32, Array32]:
    """Entry and exit of the unit ball in as many coordinates as are given; equal where it is missed."""
    a = np.maximum(np.einsum("...i,...i->...", steps, steps), _LEAST)
    b = steps @ start
    root = np.sqrt(np.maximum(np.square(b) - a * (start @ start - np.float32(1.0)), np.float32(0.0)))
    return (-b - root) / a, (-b + root) / a


def _slab(start: Array32, steps: Array32, axis: int, entry: Array32, leave: Array32) -> tuple[Array32, Array32]:
    """What remains of an interval between the planes -1 and 1 of one coordinate."""
    step = steps[..., axis]
    step = np.where(np.abs(step) < _LEAST, _LEAST, step)
    first, second = (np.float32(-1.0) - start[axis]) / step, (np.float32(1.0) - start[axis]) / step
    return np.maximum(entry, np.minimum(first, second)), np.minimum(leave, np.maximum(first, second))
