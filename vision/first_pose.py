"""A first view of the guide: which two ellipses are its rings, and in which direction its line runs."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.absorption import Absorption
from vision.conics import RingPair, depth_ratio, true_centres
from vision.detection import RingCandidate
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.projection import Intrinsics, View, project
from vision.refusal import Refusal

Array = NDArray[np.float64]

SCALE_WITHIN = 0.3  # relative: distance by the rings' separation against distance by their size
# Eq. (10) by the ellipses' axes, with some hundredths of error; the ring planes are far from the source
LEAST_DEPTH_RATIO, GREATEST_DEPTH_RATIO = 0.7, 1.05
GREATEST_TILT_RAD = math.radians(50.0)  # for a first pose; the gate on the final one is tighter
_DIRECTIONS = 720  # half degrees: half of the line's width at its end
_ON_LINE = 40
_INSET_MM = 1.5  # of the line's ends, which blur
_APART = math.radians(6.0)  # directions nearer than this to the best are the same line


@dataclass(frozen=True, slots=True, eq=False)
class FirstView:
    """A candidate view without intrinsics of its own.

    Attributes
    ----------
    view : View
        Nominal intrinsics.
    rings : RingPair
        The two ellipses.
    support : float
        Sum of both rings' supports.
    line_contrast : float
        Curvature across the line where it was found, relative to that across the rings.
    second_contrast : float
        The same for the best other direction.
    """

    view: View
    rings: RingPair
    support: float
    line_contrast: float
    second_contrast: float


def consistent_pairs(
    candidates: list[RingCandidate], guide: Guide, nominal: Intrinsics
) -> list[tuple[RingPair, float]]:
    """Pairs of ellipses that can be the guide's rings, with their summed support, the best first."""
    pairs = []
    for small in candidates:
        for big in candidates:
            rings = RingPair(small.ellipse, big.ellipse)
            if small is not big and _axis_view(rings, guide, nominal) is not None:
                pairs.append((rings, small.support + big.support))
    return sorted(pairs, key=lambda pair: -pair[1])


def first_view(
    rings: RingPair,
    support: float,
    guide: Guide,
    nominal: Intrinsics,
    absorption: Absorption,
    distortion: DistortionMap,
) -> FirstView | None:
    """The view in which the line shows best; None where the rings are no guide's."""
    upright = _axis_view(rings, guide, nominal)
    if upright is None:
        return None
    wire_px = guide.wire_diameter_mm * nominal.alpha_x_px / upright.source_from_guide[2, 3]
    curvature = _Curvature(absorption, distortion, wire_px)
    on_rings = curvature.across_rings(upright, guide)
    turns = np.linspace(0.0, 2.0 * math.pi, _DIRECTIONS, endpoint=False, dtype=np.float64)
    contrast = curvature.across_lines(upright, guide, turns) / on_rings
    best = int(np.argmax(contrast))
    away = np.abs((turns - turns[best] + math.pi) % (2.0 * math.pi) - math.pi) > _APART
    view = _turned(upright, float(turns[best]))
    return FirstView(view, rings, support, float(contrast[best]), float(contrast[away].max()))


def _axis_view(rings: RingPair, guide: Guide, nominal: Intrinsics) -> View | None:
    """Position and axis by the rings alone, the turn about the axis open; None where they contradict the guide.

    Eq. (10) and (11): the distance by the separation must agree with that by the rings' sizes, from which it is taken.
    """
    if not LEAST_DEPTH_RATIO < depth_ratio(rings, guide) < GREATEST_DEPTH_RATIO:
        return None
    centres = true_centres(rings, guide, nominal)
    if isinstance(centres, Refusal):
        return None
    inverse = np.linalg.inv(nominal.matrix())
    q, p = inverse @ (*centres.small_px, 1.0), inverse @ (*centres.big_px, 1.0)
    step = q - centres.depth_ratio * p
    by_separation_mm = guide.separation_mm / float(np.linalg.norm(step))
    by_size_mm = nominal.alpha_x_px * guide.small_ring_radius_mm / rings.small.semi_axes_px[0]
    if abs(math.log(by_separation_mm / by_size_mm)) > math.log1p(SCALE_WITHIN):
        return None
    axis = step / np.linalg.norm(step)
    if axis @ q / np.linalg.norm(q) < math.cos(GREATEST_TILT_RAD):
        return None
    pose = np.eye(4)
    side = np.cross((0.0, 1.0, 0.0), axis)
    side /= np.linalg.norm(side)
    pose[:3, :3] = np.column_stack((side, np.cross(axis, side), axis))
    pose[:3, 3] = by_size_mm * q
    return View(nominal, pose)


def _turned(view: View, turn_rad: float) -> View:
    """The view with the guide turned about its own axis."""
    cosine, sine = math.cos(turn_rad), math.sin(turn_rad)
    pose = view.source_from_guide.copy()
    pose[:3, :3] = pose[:3, :3] @ np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return View(view.intrinsics, pose)


class _Curvature:
    """Second derivative across a direction, read at corrected pixels."""

    def __init__(self, absorption: Absorption, distortion: DistortionMap, wire_px: float) -> None:
        self._uu, self._uv, self._vv = absorption.curvatures(max(1.0, wire_px / math.sqrt(3.0)))
        self._inside = absorption.inside
        self._distortion = distortion

    def across_lines(self, upright: View, guide: Guide, turns: Array) -> Array:
        """Median over the indicator line's length for each turn (n,) of the guide; it forgives balls and crossings."""
        x = np.linspace(guide.line_start_mm + _INSET_MM, guide.line_end_mm - _INSET_MM, _ON_LINE)
        around = np.stack(
            (np.cos(turns)[:, None] * x, np.sin(turns)[:, None] * x, np.zeros((len(turns), len(x)))), axis=2
        )
        points = project(upright, around.reshape(-1, 3)).reshape(len(turns), len(x), 2)
        along = points[:, -1] - points[:, 0]
        normals = np.column_stack((-along[:, 1], along[:, 0])) / np.linalg.norm(along, axis=1, keepdims=True)
        values = self._read(points.reshape(-1, 2), np.repeat(normals, len(x), axis=0))
        return np.asarray(np.median(values.reshape(len(turns), len(x)), axis=1))

    def across_rings(self, view: View, guide: Guide) -> float:
        """Median over both rings."""
        turn = np.linspace(0.0, 2.0 * math.pi, 240, endpoint=False)
        curves = []
        for radius_mm, z_mm in (
            (guide.small_ring_radius_mm, 0.0),
            (guide.big_ring_radius_mm, -guide.separation_mm),
        ):
            circle = np.column_stack((np.cos(turn) * radius_mm, np.sin(turn) * radius_mm, np.full_like(turn, z_mm)))
            points = project(view, circle)
            along = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
            normals = np.column_stack((-along[:, 1], along[:, 0])) / np.linalg.norm(along, axis=1, keepdims=True)
            curves.append(self._read(points, normals))
        return max(float(np.median(np.concatenate(curves))), 1e-6)

    def _read(self, points: Array, normals: Array) -> Array:
        rows, columns = self._uu.shape
        raw = np.rint(self._distortion.raw_from_corrected(points)).astype(np.intp)
        seen: NDArray[np.bool_] = np.all((raw >= 0) & (raw < (columns, rows)), axis=1)
        u, v = np.where(seen[:, None], raw, 0).T
        x, y = normals.T
        value = x * x * self._uu[v, u] + 2.0 * x * y * self._uv[v, u] + y * y * self._vv[v, u]
        return np.where(seen & self._inside[v, u], value, 0.0)
