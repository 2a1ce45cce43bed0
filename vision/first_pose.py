"""A first view of the guide: which two ellipses are its rings, and in which direction its line runs."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.conics import RingPair, depth_ratio, true_centres
from vision.curvature import Curvature
from vision.detection import RingCandidate
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.profiles import ProfileReader
from vision.projection import Intrinsics, View, project
from vision.refusal import Refusal
from vision.wire_model import Wire, sample_wires

Array = NDArray[np.float64]

SCALE_WITHIN = 0.3  # relative: distance by the rings' separation against distance by their size
# Eq. (10) by the ellipses' axes, with some hundredths of error; the ring planes are far from the source
LEAST_DEPTH_RATIO, GREATEST_DEPTH_RATIO = 0.7, 1.05
GREATEST_TILT_RAD = math.radians(50.0)  # for a first pose; the gate on the final one is tighter
_DIRECTIONS = 720  # half degrees: half of the line's width at its end
_ON_LINE = 40
_INSET_MM = 1.5  # of the line's ends, which blur
_APART = 12  # directions (6 deg) nearer than this to a better one are the same line
_MOST_DIRECTIONS = 5
_AS_GOOD = 0.7  # of the best direction's share: solved as well, and judged by line ends and bead
_WORST_MISFIT = 0.5  # of a profile's amplitude
_STRAIGHT_PX = 1.0  # from the straight line through the crests


@dataclass(frozen=True, slots=True, eq=False)
class FirstView:
    """A candidate view: nominal intrinsics, and the line's curvature relative to that across the rings."""

    view: View
    line_contrast: float


def consistent_pairs(candidates: list[RingCandidate], guide: Guide, nominal: Intrinsics) -> list[tuple[View, RingPair]]:
    """Views of the pairs of ellipses that can be the guide's rings, the best supported first; the turn is open."""
    pairs: list[tuple[float, View, RingPair]] = []
    for small in candidates:
        for big in candidates:
            rings = RingPair(small.ellipse, big.ellipse)
            view = None if small is big else _axis_view(rings, guide, nominal)
            if view is not None:
                pairs.append((small.support + big.support, view, rings))
    return [(view, rings) for _, view, rings in sorted(pairs, key=lambda pair: -pair[0])]


def first_views(upright: View, guide: Guide, directions: "LineDirections", reader: ProfileReader) -> list[FirstView]:
    """The view turned to where the line shows, the best first; more than one where several lines do.

    Bone edges and end plates bend the ground more than a wire does, so the strongest few directions are compared by how
    much of the line looks like one straight wire.
    """
    turns = np.linspace(0.0, 2.0 * math.pi, _DIRECTIONS, endpoint=False, dtype=np.float64)
    contrast = directions.across_lines(upright, guide, turns) / directions.across_rings(upright, guide)
    found = []
    for index in _peaks(contrast):
        view = _turned(upright, float(turns[index]))
        found.append((_line_share(view, guide, reader), FirstView(view, float(contrast[index]))))
    best = max(share for share, _ in found)
    found = [(share, first) for share, first in found if share >= _AS_GOOD * best]
    return [first for _, first in sorted(found, key=lambda pair: -pair[0])]


def _peaks(contrast: Array) -> list[int]:
    """The few directions of greatest contrast, no two of them the same line's."""
    left, peaks = contrast.copy(), []
    around = np.arange(-_APART, _APART + 1)
    for _ in range(_MOST_DIRECTIONS):
        peak = int(np.argmax(left))
        peaks.append(peak)
        left[(peak + around) % len(left)] = -np.inf
    return peaks


def _line_share(view: View, guide: Guide, reader: ProfileReader) -> float:
    """Share of the line's length on which there is a wire, all of it on one straight line."""
    samples = sample_wires(view, guide)
    line = samples.chosen(samples.wire == Wire.LINE)
    profiles = reader.read(line.points, line.normals)
    like_wire = (profiles.amplitude > 0.0) & (profiles.misfit < _WORST_MISFIT * profiles.amplitude)
    if like_wire.sum() < _ON_LINE // 4:
        return 0.0
    offset, along = profiles.offset_px[like_wire], line.along[like_wire]
    steps = np.subtract.outer(offset, offset)[np.triu_indices(len(along), 5)]
    slope = float(np.median(steps / np.subtract.outer(along, along)[np.triu_indices(len(along), 5)]))
    straight = np.abs(offset - slope * along - np.median(offset - slope * along)) < _STRAIGHT_PX
    return float(straight.sum()) / len(line.along)


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


class LineDirections:
    """Second derivative of the image across a direction, read at corrected pixels."""

    def __init__(self, curvature: Curvature, distortion: DistortionMap) -> None:
        self._curvature = curvature
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
        row, column, seen = self._curvature.cells_at(self._distortion.raw_from_corrected(points))
        uu, uv, vv = (part[row, column] for part in (self._curvature.uu, self._curvature.uv, self._curvature.vv))
        x, y = normals.T
        seen &= self._curvature.inside[row, column]
        return np.where(seen, x * x * uu + 2.0 * x * y * uv + y * y * vv, 0.0)
