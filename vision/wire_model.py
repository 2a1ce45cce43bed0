"""The guide's wires as curves: where their centre lines project for a view, and in which direction they run."""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from vision.devices import Guide
from vision.projection import View

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


@dataclass(frozen=True, slots=True, eq=False)
class Feet:
    """Nearest places of a wire's centre line to points of the image.

    Attributes
    ----------
    along : Array
        (n,), as in `WireSamples`; beyond a line's ends it goes on.
    distance_px : Array
        (n,), counted along the wire's normal there.
    speed_px : Array
        (n,): pixels along the wire by the unit of `along`.
    """

    along: Array
    distance_px: Array
    speed_px: Array


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
    alongs = []
    for radius_mm in (guide.small_ring_radius_mm, guide.big_ring_radius_mm):
        count = max(60, round(2.0 * np.pi * radius_mm * per_mm))
        alongs.append(np.linspace(0.0, 2.0 * np.pi, count, endpoint=False))
    count = max(20, round((guide.line_end_mm - guide.line_start_mm) * per_mm))
    alongs.append(np.linspace(guide.line_start_mm, guide.line_end_mm, count))
    return samples_at(view, guide, alongs)


def samples_at(view: View, guide: Guide, alongs: list[Array]) -> WireSamples:
    """Samples of the three wires at given places, (n,) for each wire in the order of `Wire`."""
    wire, along = np.repeat(np.arange(len(Wire)), [len(along) for along in alongs]), np.concatenate(alongs)
    points, tangents = curve(view, guide, wire, along)
    normals = _across(tangents) / np.sqrt(np.einsum("ni,ni->n", tangents, tangents))[:, None]
    return WireSamples(wire, along, points, normals)


def curve(view: View, guide: Guide, wire: Wire | NDArray[np.intp], along: Array) -> tuple[Array, Array]:
    """Corrected pixels (n, 2) of places (n,) on one wire or on wires (n,), and their derivative (n, 2) by the place."""
    wire = np.broadcast_to(wire, along.shape)
    rotation, intrinsics = view.source_from_guide[:3, :3], view.intrinsics
    in_guide = points_in_guide(guide, wire, along).T
    x, y, z = rotation @ in_guide + view.source_from_guide[:3, 3:]
    way = np.where(wire == Wire.LINE, [[1.0], [0.0]], (-in_guide[1], in_guide[0]))
    along_x, along_y, along_z = rotation[:, :2] @ way
    u, v = x / z, y / z
    alphas = np.array([intrinsics.alpha_x_px, intrinsics.alpha_y_px])
    points = np.column_stack((u, v)) * alphas + (intrinsics.u0_px, intrinsics.v0_px)
    tangents = np.column_stack(((along_x - u * along_z) / z, (along_y - v * along_z) / z)) * alphas
    return points, tangents


def feet(view: View, guide: Guide, wire: Wire, points: Array) -> Feet:
    """The nearest places on one wire's centre line.

    Parameters
    ----------
    points : Array
        (n, 2), corrected pixels, within some pixels of the wire.

    Notes
    -----
    The start is the point's place in the wire's own plane; one step along the tangent takes it to the foot, to the
    second order in the ratio of distance and radius.
    """
    pose, z_mm = view.source_from_guide, -guide.separation_mm if wire is Wire.BIG_RING else 0.0
    image_from_plane = view.intrinsics.matrix() @ np.column_stack((pose[:3, :2], pose[:3, 2] * z_mm + pose[:3, 3]))
    u, v = np.ascontiguousarray(points.T)
    plane_from_image = np.asarray(np.linalg.inv(image_from_plane), dtype=np.float64)
    x, y, _ = _carried(plane_from_image, u, v)
    if wire is Wire.LINE:
        along = x
        step = _step_to_foot(image_from_plane, u, v, x, 0.0, 1.0, 0.0)
        distance_px, speed_px = _off_foot(image_from_plane, u, v, x + step, 0.0, 1.0, 0.0)
    else:
        radius_mm = guide.small_ring_radius_mm if wire is Wire.SMALL_RING else guide.big_ring_radius_mm
        along, onto_ring = np.arctan2(y, x), radius_mm / np.sqrt(x * x + y * y)
        x, y = x * onto_ring, y * onto_ring
        step = _step_to_foot(image_from_plane, u, v, x, y, -y, x)
        x, y = _turned(x, y, step)
        distance_px, speed_px = _off_foot(image_from_plane, u, v, x, y, -y, x)
    return Feet(along + step, distance_px, speed_px)


def _step_to_foot(
    matrix: Array, u: Array, v: Array, x: Array, y: Array | float, way_x: Array | float, way_y: Array | float
) -> Array:
    """How far along a way (n,) the feet of points (n,) lie from places (n,) in a plane, in units of the way."""
    near_u, near_v, depth = _carried(matrix, x, y)
    along_u, along_v = _carried_ways(matrix, near_u, near_v, depth, way_x, way_y)
    return ((u - near_u) * along_u + (v - near_v) * along_v) / (along_u * along_u + along_v * along_v)


def _off_foot(
    matrix: Array, u: Array, v: Array, x: Array, y: Array | float, way_x: Array | float, way_y: Array | float
) -> tuple[Array, Array]:
    """Distances (n,) of points across the ways through their feet, and the lengths (n,) of these ways, px."""
    near_u, near_v, depth = _carried(matrix, x, y)
    along_u, along_v = _carried_ways(matrix, near_u, near_v, depth, way_x, way_y)
    speed_px = np.sqrt(along_u * along_u + along_v * along_v)
    return ((v - near_v) * along_u - (u - near_u) * along_v) / speed_px, speed_px


def _carried(matrix: Array, x: Array, y: Array | float) -> tuple[Array, Array, Array]:
    """Places (n,) of a plane under a homography (3, 3), and their depths (n,)."""
    (a, b, c), (d, e, f), (g, h, i) = matrix.tolist()
    depth = g * x + (h * y + i)
    return (a * x + (b * y + c)) / depth, (d * x + (e * y + f)) / depth, depth


def _carried_ways(
    matrix: Array, u: Array, v: Array, depth: Array, way_x: Array | float, way_y: Array | float
) -> tuple[Array, Array]:
    """Derivatives (n,) of carried places (n,) along the ways there."""
    (a, b, _), (d, e, _), (g, h, _) = matrix.tolist()
    deeper = g * way_x + h * way_y
    return (a * way_x + b * way_y - u * deeper) / depth, (d * way_x + e * way_y - v * deeper) / depth


def _turned(x: Array, y: Array, angle_rad: Array) -> tuple[Array, Array]:
    """Places (n,) on a circle about the origin after small turns (n,), to the fourth order."""
    square = angle_rad * angle_rad
    cosine, sine = 1.0 - square / 2.0, angle_rad * (1.0 - square / 6.0)
    return x * cosine - y * sine, y * cosine + x * sine


def _across(tangents: Array) -> Array:
    return np.column_stack((-tangents[:, 1], tangents[:, 0]))
