"""Lengths in mm that rays run inside simple bodies; all rays leave one origin, directions are unit vectors (n, 3)."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_APPROACH_ROUNDS = 5  # quadratic convergence from a start within a wire's width
_ROOT_ROUNDS = 5
_NEAR_WIRES = 5.0  # a ray that passes the ring's plane further off meets no wire unless the ring is seen edge-on
_FLATTEST_Z = 1e-6  # of a direction's component along an axis


def ball_chord(origin: Array, rays: Array, radius_mm: float) -> Array:
    """Chord (n,) through a ball about the frame's origin."""
    along = rays @ origin
    missing = origin @ origin - np.square(along)
    chord: Array = 2.0 * np.sqrt(np.maximum(radius_mm**2 - missing, 0.0))
    return chord


def rod_chord(origin: Array, rays: Array, start_mm: float, end_mm: float, radius_mm: float) -> Array:
    """Chord (n,) through a straight round wire along x, cut square at both ends."""
    entry, leave = _inside_cylinder(origin[[1, 2]], rays[:, [1, 2]], radius_mm)
    return _within(entry, leave, origin[0], rays[:, 0], (start_mm, end_mm))


def shell_chord(origin: Array, rays: Array, outer_mm: float, inner_mm: float, ends_mm: tuple[float, float]) -> Array:
    """Chord (n,) through the wall of a tube along z."""
    walls = [
        _within(*_inside_cylinder(origin[:2], rays[:, :2], radius), origin[2], rays[:, 2], ends_mm)
        for radius in (outer_mm, inner_mm)
    ]
    wall: Array = walls[0] - walls[1]
    return wall


def ring_chord(origin: Array, rays: Array, radius_mm: float, wire_mm: float) -> Array:
    """Chord (n,) through a torus about z, in z = 0: circle of `radius_mm`, wire of radius `wire_mm`.

    The exact entry and exit are found by Newton steps from the ray's closest approach to the circle. One crossing a
    ray is counted, that near its passage through z = 0, so the ring must not be seen edge-on.
    """
    steep = np.where(np.abs(rays[:, 2]) < _FLATTEST_Z, _FLATTEST_Z, rays[:, 2])
    passage = -origin[2] / steep
    at_plane = np.hypot(origin[0] + passage * rays[:, 0], origin[1] + passage * rays[:, 1])
    near = np.flatnonzero(np.abs(at_plane - radius_mm) < _NEAR_WIRES * wire_mm)
    chord = np.zeros(len(rays))
    chord[near] = _chord_near_ring(origin, rays[near], passage[near], radius_mm, wire_mm)
    return chord


def _chord_near_ring(origin: Array, rays: Array, along: Array, radius_mm: float, wire_mm: float) -> Array:
    """Chord (n,) of rays that pass the ring's plane near its circle, at the parameters `along`."""
    for _ in range(_APPROACH_ROUNDS):
        nearest, tangent = _nearest_on_circle(origin + along[:, None] * rays, radius_mm)
        along = _closest_to_line(origin, rays, nearest, tangent)
    points = origin + along[:, None] * rays
    gap = points - _nearest_on_circle(points, radius_mm)[0]
    inside = np.sum(np.square(gap), axis=1) < wire_mm**2
    chord = np.zeros(len(rays))
    ends = [_surface(origin, rays[inside], along[inside], side * wire_mm, radius_mm, wire_mm) for side in (-1.0, 1.0)]
    chord[inside] = ends[1] - ends[0]
    return chord


def _surface(origin: Array, rays: Array, middle: Array, start: float, radius_mm: float, wire_mm: float) -> Array:
    """Newton for the torus' surface from outside it, on one side of the closest approach."""
    along = middle + 1.5 * start
    for _ in range(_ROOT_ROUNDS):
        point = origin + along[:, None] * rays
        gap = point - _nearest_on_circle(point, radius_mm)[0]
        value = np.sum(np.square(gap), axis=1) - wire_mm**2
        slope = 2.0 * np.sum(gap * rays, axis=1)
        safe = np.where(np.abs(slope) < 1e-9, np.copysign(1e-9, start), slope)
        along = along - np.clip(value / safe, -wire_mm, wire_mm)
    return along


def _nearest_on_circle(points: Array, radius_mm: float) -> tuple[Array, Array]:
    """Nearest points of the circle in z = 0, and the circle's unit tangents there."""
    outward = points[:, :2] / np.maximum(np.hypot(points[:, 0], points[:, 1]), 1e-9)[:, None]
    nil = np.zeros(len(points))
    nearest = np.column_stack([radius_mm * outward, nil])
    return nearest, np.column_stack([-outward[:, 1], outward[:, 0], nil])


def _closest_to_line(origin: Array, rays: Array, point: Array, tangent: Array) -> Array:
    """Parameter on each ray of its closest approach to the line through a point along a tangent."""
    offset = origin - point
    cosine = np.sum(rays * tangent, axis=1)
    across = np.sum(offset * tangent, axis=1) * cosine - np.sum(offset * rays, axis=1)
    closest: Array = across / np.maximum(1.0 - np.square(cosine), 1e-6)
    return closest


def _inside_cylinder(origin: Array, rays: Array, radius_mm: float) -> tuple[Array, Array]:
    """Entry and exit parameters of an endless cylinder about the origin of two coordinates; equal where missed."""
    a = np.maximum(np.sum(np.square(rays), axis=1), 1e-12)
    b = rays @ origin
    root = np.sqrt(np.maximum(np.square(b) - a * (origin @ origin - radius_mm**2), 0.0))
    return (-b - root) / a, (-b + root) / a


def _within(entry: Array, leave: Array, origin: float, rays: Array, ends_mm: tuple[float, float]) -> Array:
    """What remains of an interval between two planes across one axis."""
    steep = np.where(np.abs(rays) < _FLATTEST_Z, _FLATTEST_Z, rays)
    first, second = (ends_mm[0] - origin) / steep, (ends_mm[1] - origin) / steep
    entry = np.maximum(entry, np.minimum(first, second))
    leave = np.minimum(leave, np.maximum(first, second))
    kept: Array = np.maximum(leave - entry, 0.0)
    return kept
