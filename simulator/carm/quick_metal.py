"""The shadows of wires, bead and balls, closely followed only where they fall."""

import numpy as np
from numpy.typing import NDArray

from simulator.carm.camera import Camera
from simulator.carm.chords import ball_chord, rod_chord
from simulator.carm.distortion import Distortion
from simulator.carm.guide import METAL_PER_MM, GuideShape, Part
from simulator.carm.plate import BALL_PER_MM, Plate

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

_APPROACH_ROUNDS = 2  # from a start within some wires of the circle: to a thousandth of a wire
_NEAR_WIRES = 5.0  # a ray that passes the ring's plane further off meets no wire unless the ring is seen edge-on
_BALL_RIM_PX = 1.5  # around a ball: half a pixel and what the local map leaves


def quick_metal_depths(shape: GuideShape, origin: Array, rays: Array) -> Array:
    """Optical depth (n,) of wires and bead along rays from one origin (3,), unit directions (n, 3), guide frame."""
    wire = shape.wire_diameter_mm / 2.0
    chord = np.zeros(len(rays))
    if Part.SMALL_RING in shape.parts:
        _add_ring(chord, origin, rays, shape.small_radius_mm, wire)
    if Part.BIG_RING in shape.parts:
        centre = np.array([*shape.big_centre_mm, -shape.separation_mm])
        _add_ring(chord, origin - centre, rays, shape.big_radius_mm, wire)
    if Part.LINE in shape.parts:
        chord += rod_chord(origin, rays, shape.line_start_mm, shape.line_end_mm, wire)
    if Part.BEAD in shape.parts:
        chord += ball_chord(origin - np.array(shape.bead_mm), rays, shape.bead_diameter_mm / 2.0)
    return METAL_PER_MM * chord


def _add_ring(chord: Array, origin: Array, rays: Array, radius_mm: float, wire_mm: float) -> None:
    """Add the chord (n,) through a torus about z in z = 0; one crossing a ray, that near its passage through z = 0.

    The squared distance from the circle is followed along the ray to second order about its minimum, which leaves a
    share of (wire / radius)^2 of the chord.
    """
    along = -origin[2] / rays[:, 2]
    near = np.flatnonzero(
        np.abs(np.hypot(origin[0] + along * rays[:, 0], origin[1] + along * rays[:, 1]) - radius_mm)
        < _NEAR_WIRES * wire_mm
    )
    rays, along = rays[near], along[near]
    for _ in range(_APPROACH_ROUNDS):
        _, slope, bend = _from_circle(origin, rays, along, radius_mm)
        along = along - slope / bend
    squared, slope, bend = _from_circle(origin, rays, along, radius_mm)
    inside = np.maximum(slope**2 + bend * (wire_mm**2 - squared), 0.0)
    chord[near] += 2.0 * np.sqrt(inside) / bend


def _from_circle(origin: Array, rays: Array, along: Array, radius_mm: float) -> tuple[Array, Array, Array]:
    """Squared distance (n,) of points on rays from the circle; half of its first and of its second derivative."""
    x, y, z = (origin[axis] + along * rays[:, axis] for axis in range(3))
    from_axis = np.hypot(x, y)
    outwards = (x * rays[:, 0] + y * rays[:, 1]) / from_axis
    flat = 1.0 - rays[:, 2] ** 2
    slope = outwards * (from_axis - radius_mm) + z * rays[:, 2]
    bend = 1.0 - radius_mm / from_axis * (flat - outwards**2)
    return (from_axis - radius_mm) ** 2 + z**2, slope, bend


def ball_patches(
    plate: Plate, camera: Camera, distortion: Distortion, parts: Array
) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
    """Raw pixels around the plate's balls and what the balls let through there.

    Parameters
    ----------
    parts : (k, 2)
        Places within a pixel over which the mean is taken.

    Returns
    -------
    (n,), (n,), (n,)
        u, v, and the share of the intensity that passes.
    """
    ideal = plate.balls_ideal_px(camera)
    raw = distortion.raw_from_ideal(ideal)
    by_u, by_v = (
        (distortion.ideal_from_raw(raw + step) - distortion.ideal_from_raw(raw - step)).astype(np.float32)
        for step in np.eye(2) / 2.0
    )
    reach = int(np.ceil(plate.ball_diameter_mm / 2.0 / camera.pixel_mm + _BALL_RIM_PX))
    steps = np.arange(-reach, reach + 1)
    middle = np.rint(raw).astype(np.intp)
    u, v = (axis.ravel() + middle[:, i, None] for i, axis in enumerate(np.meshgrid(steps, steps)))
    passed = np.zeros(u.shape, dtype=np.float32)
    for part in parts:
        du, dv = ((place + part[i] - raw[:, i, None]).astype(np.float32) for i, place in enumerate((u, v)))
        off_u, off_v = (du * by_u[:, i, None] + dv * by_v[:, i, None] for i in (0, 1))
        passed += np.exp(-_ball_depths(plate, camera, ideal[:, 0, None], off_u, off_v))
    seen = (u >= 0) & (u < camera.columns) & (v >= 0) & (v < camera.rows)
    return u[seen], v[seen], passed[seen] / len(parts)


def _ball_depths(plate: Plate, camera: Camera, middle_u_px: Array, off_u_px: Array32, off_v_px: Array32) -> Array32:
    """Optical depth (n, k) at offsets (n, k) from the balls' middles (n, 1), ideal pixels."""
    squared = (off_u_px**2 + off_v_px**2) * np.float32(camera.pixel_mm**2)
    chord: Array32 = np.sqrt(np.maximum(np.float32((plate.ball_diameter_mm / 2.0) ** 2) - squared, np.float32(0.0)))
    if plate.covered_to_mm is not None:
        covered_to_px = plate.covered_to_mm / camera.pixel_mm + camera.principal_u_px
        chord[middle_u_px + off_u_px < covered_to_px] = 0.0
    return np.float32(2.0 * BALL_PER_MM) * chord
