"""The guide's wires as curves: where their centre lines project for a view, and in which direction they run."""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from vision.devices import Guide
from vision.projection import View, project

Array = NDArray[np.float64]


class Wire(IntEnum):
    """Which wire a sample lies on."""

    SMALL_RING = 0
    BIG_RING = 1
    LINE = 2


@dataclass(frozen=True, slots=True, eq=False)
class WireSamples:
    """Places on the wires about a pixel apart.

    Attributes
    ----------
    wire : NDArray[np.intp]
        (n,), a `Wire` each.
    along : Array
        (n,): angle about the guide's z on a ring, rad; x on the line, mm.
    points : Array
        (n, 2), corrected pixels.
    normals : Array
        (n, 2), unit, across the wire's image.
    """

    wire: NDArray[np.intp]
    along: Array
    points: Array
    normals: Array

    def chosen(self, mask: NDArray[np.bool_]) -> "WireSamples":
        """Some of the samples."""
        return WireSamples(self.wire[mask], self.along[mask], self.points[mask], self.normals[mask])


def with_dimensions(guide: Guide, small_radius_mm: float, big_radius_mm: float, separation_mm: float) -> Guide:
    """The guide with the three dimensions that the fit may move within their tolerances."""
    return replace(
        guide,
        small_ring_radius_mm=small_radius_mm,
        big_ring_radius_mm=big_radius_mm,
        separation_mm=separation_mm,
    )


def points_in_guide(guide: Guide, wire: NDArray[np.intp], along: Array) -> Array:
    """Centre-line points (n, 3), guide frame, mm."""
    radius = np.where(wire == Wire.SMALL_RING, guide.small_ring_radius_mm, guide.big_ring_radius_mm)
    on_line = wire == Wire.LINE
    x = np.where(on_line, along, radius * np.cos(along))
    y = np.where(on_line, 0.0, radius * np.sin(along))
    return np.column_stack((x, y, np.where(wire == Wire.BIG_RING, -guide.separation_mm, 0.0)))


def dimension_directions(wire: NDArray[np.intp], along: Array) -> Array:
    """How centre-line points move with small radius, big radius and separation: (n, 3, 3), guide axes by dimension."""
    outwards = np.column_stack((np.cos(along), np.sin(along)))
    moves = np.zeros((len(along), 3, 3))
    for dimension, ring in enumerate((Wire.SMALL_RING, Wire.BIG_RING)):
        moves[:, :2, dimension] = np.where((wire == ring)[:, None], outwards, 0.0)
    moves[wire == Wire.BIG_RING, 2, 2] = -1.0
    return moves


def sample_wires(view: View, guide: Guide) -> WireSamples:
    """Samples of all three wires, about one corrected pixel apart."""
    depth_mm = float(view.source_from_guide[2, 3])
    per_mm = view.intrinsics.alpha_x_px / depth_mm
    wires, alongs = [], []
    for wire, radius_mm in (
        (Wire.SMALL_RING, guide.small_ring_radius_mm),
        (Wire.BIG_RING, guide.big_ring_radius_mm),
    ):
        count = max(60, round(2.0 * np.pi * radius_mm * per_mm))
        alongs.append(np.linspace(0.0, 2.0 * np.pi, count, endpoint=False))
        wires.append(np.full(count, wire, dtype=np.intp))
    count = max(20, round((guide.line_end_mm - guide.line_start_mm) * per_mm))
    alongs.append(np.linspace(guide.line_start_mm, guide.line_end_mm, count))
    wires.append(np.full(count, Wire.LINE, dtype=np.intp))
    return _projected(view, guide, np.concatenate(wires), np.concatenate(alongs))


def _projected(view: View, guide: Guide, wire: NDArray[np.intp], along: Array) -> WireSamples:
    step = np.where(wire == Wire.LINE, 0.1, 0.005)
    ahead = project(view, points_in_guide(guide, wire, along + step))
    behind = project(view, points_in_guide(guide, wire, along - step))
    tangent = ahead - behind
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    points = project(view, points_in_guide(guide, wire, along))
    return WireSamples(wire, along, points, np.column_stack((-tangent[:, 1], tangent[:, 0])))
