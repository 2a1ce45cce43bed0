"""Where the wires really are: the pixels of a band along each wire, explained piece by piece.

A piece is a few pixels of a wire's length. Its pixels are the wire's shadow, shifted across; a smooth ground; and what
crosses: other wires, balls, the bead. Every pixel counts once, at its own place, so that nothing is interpolated.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from vision.devices import Guide
from vision.distortion import PlateFit
from vision.pieces import Pieces
from vision.projection import View, project
from vision.shadows import Window, ball_shadows
from vision.wire_model import Wire, feet, sample_wires, samples_at
from vision.wire_shape import Profile, ball_profile, wire_profile

Array = NDArray[np.float64]

DETECTOR_BLUR_MM = 0.38  # standard deviation: screen, optics and focal spot of an intensifier
_REACH = 1.2  # half width of a band, in wire widths: farther off the ground is no longer smooth
_PIECE = 0.9  # length of a piece in wire widths: short against the ground's waves
_LEAST_PIECE_PX = 4.0  # so that a piece has some five pixels for each of its unknowns
_END_MARGIN = 0.7  # in wire widths, kept free of the line's own ends


@dataclass(frozen=True, slots=True, eq=False)
class Shadows:
    """What an image's wires and balls look like.

    Attributes
    ----------
    depth : float
        Absorption at a wire's middle.
    blur_px : float
        Standard deviation of the detector's blur.
    balls_raw : Array
        (m, 2), raw pixels of the plate's balls.
    ball_radius_px : float
        Corrected pixels.
    """

    depth: float
    blur_px: float
    balls_raw: Array
    ball_radius_px: float


@dataclass(frozen=True, slots=True, eq=False)
class _Wires:
    """What all three bands share: the image's part, its corrected pixels (2, n), the wires' profiles and masks."""

    view: View
    guide: Guide
    plate: PlateFit
    window: Window
    corrected: Array
    profiles: dict[Wire, Profile]
    width_px: dict[Wire, float]
    masks: dict[Wire, NDArray[np.bool_]]
    blur_px: float


def cut_pieces(view: View, guide: Guide, plate: PlateFit, values: NDArray[np.float32], shadows: Shadows) -> Pieces:
    """The bands of all three wires, cut into pieces.

    Parameters
    ----------
    view, guide
        The present estimate, within a pixel.
    plate : PlateFit
        Its map places the raw pixels.
    values : NDArray[np.float32]
        Absorption (rows, columns) of the raw image.
    shadows : Shadows
        Of this image.
    """
    wires = _laid_out(view, guide, plate, values, shadows)
    seen, crossing = wires.window.cut(values).ravel(), _balls(wires, shadows).ravel()
    alongs: list[Array] = []
    bands: list[_Band] = []
    for wire in Wire:
        middles, band = _band(wires, wire, sum(map(len, alongs)))
        alongs.append(middles)
        bands.append(band)
    pixel, piece = (np.concatenate([getattr(band, name) for band in bands]) for name in ("pixel", "piece"))
    rows = np.concatenate([band.rows for band in bands], axis=1)
    rows = np.vstack((rows, crossing[pixel], seen[pixel], np.exp(-shadows.depth * rows[0])))  # fewer quanta behind it
    samples = samples_at(view, guide, alongs)
    reach_px = np.repeat([_REACH * wires.width_px[wire] for wire in Wire], [len(along) for along in alongs])
    return Pieces.of(samples, reach_px, piece, rows)


def _laid_out(view: View, guide: Guide, plate: PlateFit, values: NDArray[np.float32], shadows: Shadows) -> _Wires:
    samples = sample_wires(view, guide)
    raw = plate.map.raw_from_corrected(samples.points)
    widths, profiles = {}, {}
    for wire in Wire:
        z_mm = -guide.separation_mm if wire is Wire.BIG_RING else 0.0
        depth_mm = float(view.source_from_guide[2, 2] * z_mm + view.source_from_guide[2, 3])
        widths[wire] = guide.wire_diameter_mm * view.intrinsics.alpha_x_px / depth_mm
        profiles[wire] = wire_profile(widths[wire] / 2.0, shadows.depth, shadows.blur_px)
    margin_px = 2.0 * _REACH * max(widths.values())
    window = Window.around(raw, margin_px, *values.shape)
    masks = {}
    for wire in Wire:
        path = np.rint(raw[samples.wire == wire] - (window.left, window.top)).astype(np.int32)
        mask = np.zeros((window.rows, window.columns), dtype=np.uint8)
        thickness = 2 * int(np.ceil(_REACH * widths[wire])) + 3
        cv2.polylines(mask, [path], wire is not Wire.LINE, (1,), thickness)
        masks[wire] = mask.view(np.bool_)
    corrected = plate.map.corrected_window(window.left, window.top, window.columns, window.rows).reshape(2, -1)
    return _Wires(view, guide, plate, window, corrected, profiles, widths, masks, shadows.blur_px)


def _balls(wires: _Wires, shadows: Shadows) -> Array:
    """Shadows (rows, columns) of balls and bead, in the window."""
    view, guide, distortion = wires.view, wires.guide, wires.plate.map
    drawn = np.zeros((wires.window.rows, wires.window.columns))
    if len(shadows.balls_raw):
        profile = ball_profile(shadows.ball_radius_px, shadows.depth, shadows.blur_px)
        drawn += ball_shadows(wires.window, _near_bands(wires, shadows.balls_raw, profile), distortion, profile)
    if guide.bead is not None:
        place = np.array([guide.bead.position_mm])
        depth_mm = float(view.source_from_guide[2, :3] @ place[0] + view.source_from_guide[2, 3])
        radius_px = view.intrinsics.alpha_x_px * guide.bead.diameter_mm / 2.0 / depth_mm
        per_wire = guide.bead.diameter_mm / guide.wire_diameter_mm
        profile = ball_profile(radius_px, per_wire * shadows.depth, shadows.blur_px)
        centre = distortion.raw_from_corrected(project(view, place))
        drawn += per_wire * ball_shadows(wires.window, centre, distortion, profile)
    return drawn


def _near_bands(wires: _Wires, balls_raw: Array, profile: Profile) -> Array:
    """Those balls (m, 2) whose shadows may reach a band."""
    window, side = wires.window, 2 * math.ceil(profile.reach_px) + 1
    bands = np.logical_or.reduce(list(wires.masks.values()))
    reached = cv2.dilate(bands.view(np.uint8), np.ones((side, side), np.uint8))
    u, v = (np.rint(balls_raw).astype(np.intp) - (window.left, window.top)).T
    inside = (u >= 0) & (u < window.columns) & (v >= 0) & (v < window.rows)
    return np.asarray(balls_raw[inside & (reached[np.where(inside, v, 0), np.where(inside, u, 0)] > 0)])


@dataclass(frozen=True, slots=True, eq=False)
class _Band:
    """Pixels of one wire's band.

    Attributes
    ----------
    pixel, piece : NDArray[np.intp]
        (n,) each: place in the window, row by row; number of the piece.
    rows : Array
        (5, n): the shadow's height and its derivative by the shift; distances across and along, in units of the reach;
        what other wires add.
    """

    pixel: NDArray[np.intp]
    piece: NDArray[np.intp]
    rows: Array


def _band(wires: _Wires, wire: Wire, first_piece: int) -> tuple[Array, _Band]:
    """Middles (s,) of one wire's pieces, and their pixels."""
    pixel = np.flatnonzero(wires.masks[wire])
    corrected = wires.corrected.take(pixel, axis=1)
    at = feet(wires.view, wires.guide, wire, corrected.T)
    reach_px = _REACH * wires.width_px[wire]
    middles, piece, from_middle = _divided(wires, wire, at.along, float(np.median(at.speed_px)))
    inside = np.flatnonzero((np.abs(at.distance_px) < reach_px) & (piece >= 0))
    d, along, pixel = at.distance_px[inside], (from_middle * at.speed_px)[inside] / reach_px, pixel[inside]
    profile = wires.profiles[wire]
    others = _others(wires, wire, corrected.take(inside, axis=1), pixel)
    rows = np.stack((profile.heights(d), -profile.slopes(d), d / reach_px, along, others))
    return middles, _Band(pixel, piece[inside] + first_piece, rows)


def _divided(wires: _Wires, wire: Wire, along: Array, speed_px: float) -> tuple[Array, NDArray[np.intp], Array]:
    """Middles of the pieces (s,); each place's piece (n,), -1 beyond the line's ends, and distance from its middle."""
    width_px = wires.width_px[wire]
    if wire is Wire.LINE:
        margin_mm = _END_MARGIN * width_px / speed_px
        start, length = wires.guide.line_start_mm + margin_mm, wires.guide.line_end_mm - wires.guide.line_start_mm
        length -= 2.0 * margin_mm
    else:
        start, length = 0.0, 2.0 * np.pi
        along = np.mod(along, length)
    count = max(4, round(length * speed_px / max(_LEAST_PIECE_PX, _PIECE * width_px)))
    piece = np.floor((along - start) / length * count).astype(np.intp)
    piece = np.where((piece >= 0) & (piece < count), piece, -1)
    middles = np.asarray(start + (np.arange(count) + 0.5) * (length / count), dtype=np.float64)
    return middles, piece, along - middles[piece]


def _others(wires: _Wires, wire: Wire, corrected: Array, pixel: NDArray[np.intp]) -> Array:
    """Shadows (n,) of the other two wires at one wire's pixels, corrected (2, n)."""
    total = np.zeros(len(pixel))
    for other in (other for other in Wire if other is not wire):
        both = np.flatnonzero(wires.masks[other].take(pixel))
        if len(both):
            at = feet(wires.view, wires.guide, other, corrected.take(both, axis=1).T)
            shadow = wires.profiles[other].heights(at.distance_px)
            if other is Wire.LINE:
                sd_mm = np.sqrt(2.0) * wires.blur_px / at.speed_px
                shadow *= 0.5 * (1.0 + erf((at.along - wires.guide.line_start_mm) / sd_mm))
                shadow *= 0.5 * (1.0 + erf((wires.guide.line_end_mm - at.along) / sd_mm))
            total[both] += shadow
    return total
