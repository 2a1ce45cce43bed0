"""A first view of the guide: which two ellipses are its rings, and in which direction its line runs."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.conics import RingPair, true_centres
from vision.curvature import Curvature
from vision.detection import RingCandidate
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.profiles import ProfileReader
from vision.projection import Intrinsics, View, project
from vision.refusal import Refusal
from vision.wire_model import Wire, WireSamples, sample_wires

Array = NDArray[np.float64]

_ROUGH_SCALE_WITHIN = math.log(2.5)  # of the same by the ellipses' axes and centres alone
SCALE_WITHIN = 0.3  # relative: distance by the rings' separation against distance by their size
# Eq. (10) by the ellipses' axes, with some hundredths of error; the ring planes are far from the source
LEAST_DEPTH_RATIO, GREATEST_DEPTH_RATIO = 0.7, 1.05
GREATEST_TILT_RAD = math.radians(50.0)  # for a first pose; the gate on the final one is tighter
LEAST_LINE_CONTRAST = 0.4  # of the rings' own
_DIRECTIONS = 360  # degrees: less than the line's width at its end
_ON_LINE = 24
_EVERY = 2  # sample of the line whose profile is read to compare directions
_LEAST_ON_LINE = 0.12  # share of those that must look like a wire for a slope to be taken from them
_INSET_MM = 1.5  # of the line's ends, which blur
_APART = 3  # directions (3 deg) no farther than this from a better one are the same line: its width where it starts
_MOST_DIRECTIONS = 5
_AS_GOOD = 0.7  # of the best direction's share: solved as well, and judged by line ends and bead
_WORST_MISFIT = 0.5  # of a profile's amplitude
_STRAIGHT_SD = 0.6  # standard deviations of a crest's width, from the straight line through the crests


@dataclass(frozen=True, slots=True, eq=False)
class RingView:
    """Two ellipses as the guide's rings, how well each is supported (2,), and the view they make; its turn is open."""

    rings: RingPair
    supports: tuple[float, float]
    view: View


@dataclass(frozen=True, slots=True, eq=False)
class FirstView:
    """A candidate view: nominal intrinsics, and the line's curvature relative to that across the rings."""

    view: View
    line_contrast: float


def consistent_pairs(candidates: list[RingCandidate], guide: Guide, nominal: Intrinsics, most: int) -> list[RingView]:
    """Views of the pairs of ellipses that can be the guide's rings, the best supported first, so many at most."""
    views = (
        (small, big, _axis_view(RingPair(small.ellipse, big.ellipse), guide, nominal))
        for small, big in _possible_pairs(candidates, guide, nominal)
    )
    found = (
        RingView(RingPair(small.ellipse, big.ellipse), (small.support, big.support), view)
        for small, big, view in views
        if view is not None
    )
    return list(itertools.islice(found, most))


def _possible_pairs(
    candidates: list[RingCandidate], guide: Guide, nominal: Intrinsics
) -> Iterator[tuple[RingCandidate, RingCandidate]]:
    """Small and big rings that sizes and the ellipses' centres, which are nearly the rings', do not rule out.

    The best supported first.
    """
    major = np.array([candidate.ellipse.semi_axes_px[0] for candidate in candidates])
    centre = np.array([candidate.ellipse.centre_px for candidate in candidates])
    on_plane = (centre - (nominal.u0_px, nominal.v0_px)) / nominal.alpha_x_px
    ratio = (guide.big_ring_radius_mm * major[:, None]) / (guide.small_ring_radius_mm * major)
    apart = np.linalg.norm(on_plane[:, None] - ratio[:, :, None] * on_plane, axis=2)
    by_separation_mm = guide.separation_mm / np.maximum(np.hypot(apart, 1.0 - ratio), np.finfo(float).tiny)
    by_size_mm = nominal.alpha_x_px * guide.small_ring_radius_mm / major[:, None]
    possible = (ratio > LEAST_DEPTH_RATIO) & (ratio < GREATEST_DEPTH_RATIO)
    possible &= np.abs(np.log(by_separation_mm / by_size_mm)) < _ROUGH_SCALE_WITHIN
    support = np.array([candidate.support for candidate in candidates])
    small, big = np.nonzero(possible)
    for index in np.argsort(-(support[small] + support[big]), kind="stable"):
        yield candidates[small[index]], candidates[big[index]]


def first_views(pair: RingView, guide: Guide, directions: "LineDirections", reader: ProfileReader) -> list[FirstView]:
    """The view turned to where the line shows, the best first; more than one where several lines do.

    Bone edges and end plates bend the ground more than a wire does, so the strongest few directions are compared by how
    much of the line looks like one straight wire.
    """
    upright = pair.view
    turns = np.linspace(0.0, 2.0 * math.pi, _DIRECTIONS, endpoint=False, dtype=np.float64)
    contrast = directions.across_lines(upright, guide, turns) / directions.across_rings(upright, guide)
    peaks = _peaks(contrast)
    if len(peaks) == 1:
        return [FirstView(_turned(upright, float(turns[peaks[0]])), float(contrast[peaks[0]]))]
    views = [_turned(upright, float(turns[index])) for index in peaks]
    firsts = [FirstView(view, float(contrast[index])) for view, index in zip(views, peaks, strict=True)]
    shares = _line_shares(views, guide, reader)
    order = np.argsort(-shares, kind="stable")
    return [firsts[index] for index in order if shares[index] >= _AS_GOOD * shares.max()]


def _peaks(contrast: Array) -> list[int]:
    """The greatest contrast's direction, and the next few that may be a line's, no two of them the same line's."""
    around = np.arange(-_APART, _APART + 1)
    summits = contrast >= contrast[(np.arange(len(contrast))[:, None] + around) % len(contrast)].max(axis=1)
    found = np.flatnonzero(summits & (contrast >= LEAST_LINE_CONTRAST))
    order = found[np.argsort(-contrast[found], kind="stable")]
    return order[:_MOST_DIRECTIONS].tolist() or [int(np.argmax(contrast))]


def _line_shares(views: list[View], guide: Guide, reader: ProfileReader) -> Array:
    """Shares (n,) of the line's length in each view on which there is a wire, all of it on one straight line."""
    lines = [_line_samples(view, guide) for view in views]
    points, normals = (np.concatenate([getattr(line, name) for line in lines]) for name in ("points", "normals"))
    profiles = reader.read(points, normals)
    like_wire = (profiles.amplitude > 0.0) & (profiles.misfit < _WORST_MISFIT * profiles.amplitude)
    ends = np.cumsum([len(line.along) for line in lines])[:-1]
    each = zip(lines, np.split(profiles.offset_px, ends), np.split(like_wire, ends), strict=True)
    within_px = _STRAIGHT_SD * reader.crest_sd_px
    return np.array([_straight_share(line.along, offset, like, within_px) for line, offset, like in each])


def _line_samples(view: View, guide: Guide) -> WireSamples:
    samples = sample_wires(view, guide)
    return samples.chosen((samples.wire == Wire.LINE) & (np.arange(len(samples.along)) % _EVERY == 0))


def _straight_share(along: Array, offset_px: Array, like_wire: NDArray[np.bool_], within_px: float) -> float:
    """Share of a line's places (n,) that look like a wire's and whose crests lie on one straight line."""
    every, offset, along = len(along), offset_px[like_wire], along[like_wire]
    if len(along) < _LEAST_ON_LINE * every:
        return 0.0
    pairs = np.triu_indices(len(along), len(along) // 8 + 1)  # neighbours say little about the slope
    slope = float(np.median((offset[pairs[0]] - offset[pairs[1]]) / (along[pairs[0]] - along[pairs[1]])))
    straight = np.abs(offset - slope * along - np.median(offset - slope * along)) < within_px
    return float(straight.sum()) / every


def _axis_view(rings: RingPair, guide: Guide, nominal: Intrinsics) -> View | None:
    """Position and axis by the rings alone, the turn about the axis open; None where they contradict the guide.

    Eq. (10) and (11): the distance by the separation must agree with that by the rings' sizes, from which it is taken.
    """
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
        cell, seen = self._curvature.cells_at(self._distortion.raw_from_corrected(points))
        uu, uv, vv = (part.take(cell) for part in (self._curvature.uu, self._curvature.uv, self._curvature.vv))
        x, y = normals.T
        seen &= self._curvature.inside.take(cell)
        return np.where(seen, x * x * uu + 2.0 * x * y * uv + y * y * vv, 0.0)
