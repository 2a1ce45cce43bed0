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
    curves = [curve(view, guide, wire, along) for wire, along in zip(Wire, alongs, strict=True)]
    points, tangents = (np.concatenate(parts) for parts in zip(*curves, strict=True))
    normals = _across(tangents) / np.linalg.norm(tangents, axis=1, keepdims=True)
    wires = np.repeat(np.array(list(Wire), dtype=np.intp), [len(along) for along in alongs])
    return WireSamples(wires, np.concatenate(alongs), points, normals)


def curve(view: View, guide: Guide, wire: Wire, along: Array) -> tuple[Array, Array]:
    """Corrected pixels (n, 2) of one wire's places (n,), and their derivative (n, 2) by the place."""
    wires = np.full(len(along), wire, dtype=np.intp)
    rotation, intrinsics = view.source_from_guide[:3, :3], view.intrinsics
    in_guide = points_in_guide(guide, wires, along)
    x, y, z = (in_guide @ rotation.T + view.source_from_guide[:3, 3]).T
    if wire is Wire.LINE:
        moves = np.tile(rotation[:, 0], (len(along), 1))
    else:
        moves = np.column_stack((-in_guide[:, 1], in_guide[:, 0])) @ rotation[:, :2].T
    u, v = x / z, y / z
    alphas = np.array([intrinsics.alpha_x_px, intrinsics.alpha_y_px])
    points = np.column_stack((u, v)) * alphas + (intrinsics.u0_px, intrinsics.v0_px)
    tangents = np.column_stack((moves[:, 0] - u * moves[:, 2], moves[:, 1] - v * moves[:, 2])) * alphas / z[:, None]
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
    wanted = np.ascontiguousarray(points.T)
    plane_from_image = np.linalg.inv(image_from_plane)
    in_plane = plane_from_image[:, :2] @ wanted + plane_from_image[:, 2:]
    place, way = np.ones_like(in_plane), np.zeros_like(in_plane)
    place[:2] = in_plane[:2] / in_plane[2]
    if wire is Wire.LINE:
        along, place[1], way[0] = place[0].copy(), 0.0, 1.0
    else:
        radius_mm = guide.small_ring_radius_mm if wire is Wire.SMALL_RING else guide.big_ring_radius_mm
        along = np.arctan2(place[1], place[0])
        place[:2] *= radius_mm / np.hypot(place[0], place[1])
        way[0], way[1] = -place[1], place[0]
    near, tangents = _imaged(image_from_plane, place, way)
    step = ((wanted - near) * tangents).sum(axis=0) / (tangents**2).sum(axis=0)
    if wire is Wire.LINE:
        place[0] += step
    else:
        place[:2], way[:2] = _turned(place[:2], way[:2], step)
    near, tangents = _imaged(image_from_plane, place, way)
    speed_px = np.hypot(tangents[0], tangents[1])
    away = wanted - near
    return Feet(along + step, (away[1] * tangents[0] - away[0] * tangents[1]) / speed_px, speed_px)


def _imaged(image_from_plane: Array, place: Array, way: Array) -> tuple[Array, Array]:
    """Corrected pixels (2, n) of places (3, n) in a plane, and their derivatives (2, n) along the ways (3, n)."""
    seen, moves = image_from_plane @ place, image_from_plane @ way
    near = seen[:2] / seen[2]
    return near, (moves[:2] - near * moves[2]) / seen[2]


def _turned(place: Array, way: Array, angle_rad: Array) -> tuple[Array, Array]:
    """Places on a circle (2, n) and the ways along it (2, n) after small turns (n,), to the fourth order."""
    square = angle_rad**2
    cosine, sine = 1.0 - square / 2.0, angle_rad * (1.0 - square / 6.0)
    return place * cosine + way * sine, way * cosine - place * sine


def _across(tangents: Array) -> Array:
    return np.column_stack((-tangents[:, 1], tangents[:, 0]))
