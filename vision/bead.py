"""Handedness (H05): the bead at its place or at its mirror place?

Rings and line fit a mirrored image perfectly; only the bead tells. At both places the image is explained with and
without a bead, the wires and balls that cross the patch in both, and the likelihoods are compared.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from vision.devices import Bead
from vision.profiles import ProfileReader
from vision.projection import View, project
from vision.refusal import Refusal, RefusalCode

Array = NDArray[np.float64]

LEAST_AMPLITUDE = 0.35  # of what the wires' absorption predicts for the bead's diameter; dark 8-bit images clip it
LEAST_EXPLAINED = 0.25  # share of the patch's variation that the bead must explain; a bone edge across it may hold more
CLEAR_WIN = 20.0  # difference of the logarithms of the two likelihoods
GREATEST_OTHER = 0.5  # of the amplitude at the place that wins: what the place that loses may have
_PATCH = 1.8  # half side, in bead radii
_GROUND_ORDER = 3  # of the ground's polynomial: with less, bone's edges and end plates look like half a bead
_LEAST_SIZE = 1e-9  # of the ground's largest direction; below it a column says what others say
_SEARCH_PX = 3.0  # around the predicted place: the first pose's error at the bead


@dataclass(frozen=True, slots=True, eq=False)
class BeadEvidence:
    """What one place says: centre in corrected pixels, amplitude against expectation, log likelihood ratio."""

    centre_px: Array
    amplitude: float
    explained: float
    log_ratio: float


@dataclass(frozen=True, slots=True, eq=False)
class Crossing:
    """What else may darken a patch, corrected pixels: wires' samples (n, 2); balls (m, 3) with radius in px."""

    wires: Array
    balls: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Patch:
    """Corrected pixels on a grid: u of its columns (w,) and v of its rows (h,)."""

    u: Array
    v: Array

    @property
    def pixels(self) -> Array:
        """All of them (h w, 2), row by row."""
        return np.column_stack([axis.ravel() for axis in np.meshgrid(self.u, self.v)])

    def shadows(self, centres: Array, radius_px: float, blur_px: float) -> Array:
        """Balls' shadows (s, h w) about centres (s, 2), 1 there: chords, their rims softened by the image's blur."""
        reach_px = math.hypot(radius_px, blur_px)
        across, down = (
            ((axis - centre[:, None]) / reach_px) ** 2 for axis, centre in zip((self.u, self.v), centres.T, strict=True)
        )
        depth = 1.0 - (down[:, :, None] + across[:, None, :])
        np.sqrt(np.maximum(depth, 0.0, out=depth), out=depth)
        return np.asarray(depth.reshape(len(centres), -1), dtype=np.float64)


def locate_bead(
    view: View, bead: Bead, wire_amplitude_per_mm: float, reader: ProfileReader, crossing: Crossing
) -> BeadEvidence | Refusal:
    """The bead's centre if it is at its place, clearly.

    Parameters
    ----------
    view : View
        Fitted without the bead.
    bead : Bead
        Place in the guide frame and diameter, mm.
    wire_amplitude_per_mm : float
        Absorption of the wires per mm of their diameter.
    reader : ProfileReader
        Of the image.
    crossing : Crossing
        Wires and balls.

    Returns
    -------
    BeadEvidence or Refusal
        `mirrored` where the bead is at its mirror place, `bead_missing` where it is at neither or the win is not clear.
    """
    x, y, z = bead.position_mm
    expected = wire_amplitude_per_mm * bead.diameter_mm
    place, mirror = (
        _evidence(view, np.array([x, sign * y, z]), bead, expected, reader, crossing) for sign in (1.0, -1.0)
    )
    doubt = _doubt(place, mirror)
    if doubt is None:
        return place
    if _doubt(mirror, place) is None:
        message = "the image is mirrored: the bead is at its mirror place (log likelihood ratio of its own place)"
        return Refusal(RefusalCode.MIRRORED, message, place.log_ratio - mirror.log_ratio, CLEAR_WIN)
    return doubt


def _doubt(one: BeadEvidence, other: BeadEvidence) -> Refusal | None:
    """What speaks first against the bead being at one place and not at the other."""
    won, faint = one.log_ratio - other.log_ratio, other.amplitude < GREATEST_OTHER * one.amplitude
    for passed, what, measured, limit in (
        (one.amplitude >= LEAST_AMPLITUDE, "absorption against what the wires predict", one.amplitude, LEAST_AMPLITUDE),
        (one.explained >= LEAST_EXPLAINED, "share of the patch that it explains", one.explained, LEAST_EXPLAINED),
        (won >= CLEAR_WIN, "log likelihood ratio against its mirror place", won, CLEAR_WIN),
        (faint, "absorption at its mirror place", other.amplitude, GREATEST_OTHER * one.amplitude),
    ):
        if not passed:
            return Refusal(RefusalCode.BEAD_MISSING, f"the bead is not clearly at its place: {what}", measured, limit)
    return None


def _evidence(
    view: View, place_in_guide: Array, bead: Bead, expected: float, reader: ProfileReader, crossing: Crossing
) -> BeadEvidence:
    """The best explanation with a bead within the search range of a place, against none."""
    predicted = project(view, place_in_guide[None])[0]
    depth_mm = float((view.source_from_guide[:3, :3] @ place_in_guide + view.source_from_guide[:3, 3])[2])
    radius_px = view.intrinsics.alpha_x_px * bead.diameter_mm / 2.0 / depth_mm
    reach = math.ceil(_PATCH * radius_px + _SEARCH_PX)
    steps = np.arange(-reach, reach + 1.0)
    patch = _Patch(predicted[0] + steps, predicted[1] + steps)
    values, ground = reader.values_at(patch.pixels), _ground(patch, reader, crossing)
    left, held = values - ground @ (ground.T @ values), math.inf
    without, centre, amplitude = float(left @ left), predicted, 0.0
    for spacing_px in (1.0, 0.3, 0.1):
        reach_steps = _SEARCH_PX / spacing_px if spacing_px == 1.0 else 3.0
        offsets = np.arange(-reach_steps, reach_steps + 1.0) * spacing_px
        shifts = np.column_stack([axis.ravel() for axis in np.meshgrid(offsets, offsets)]) + centre
        shadows = patch.shadows(shifts, radius_px, reader.crest_sd_px)
        # least squares of one column beside the ground's: what it takes away, and by how much of it
        match, size = shadows @ left, np.einsum("sp,sp->s", shadows, shadows) - ((shadows @ ground) ** 2).sum(axis=1)
        size = np.maximum(size, 1e-12)
        remaining = np.where(match > 0.0, without - match**2 / size, math.inf)
        best = int(np.argmin(remaining))
        if remaining[best] < held:
            held, centre, amplitude = float(remaining[best]), shifts[best], float(match[best] / size[best])
    share = min(1.0, held / max(without, 1e-12))
    log_ratio = -0.5 * len(values) * math.log(max(share, 1e-6))
    return BeadEvidence(centre, amplitude / expected, 1.0 - share, log_ratio)


def _ground(patch: _Patch, reader: ProfileReader, crossing: Crossing) -> Array:
    """Orthonormal columns of what may be there besides the bead: a bending ground, wires, balls."""
    grid = patch.pixels
    middle = grid.mean(axis=0)
    centred = grid - middle
    half_side_px = float(np.abs(centred).max())
    u, v = (centred / half_side_px).T
    columns = [u**i * v**j for i in range(_GROUND_ORDER + 1) for j in range(_GROUND_ORDER + 1 - i)]
    near = crossing.wires[((crossing.wires - middle) ** 2).sum(axis=1) < (2.0 * half_side_px) ** 2]
    if len(near):
        distance, _ = KDTree(near).query(grid)
        columns.append(np.exp(-(distance**2) / (2.0 * reader.crest_sd_px**2)))
    balls = crossing.balls[np.abs(crossing.balls[:, :2] - middle).max(axis=1) < half_side_px + crossing.balls[:, 2]]
    columns += [patch.shadows(ball[None, :2], ball[2], reader.crest_sd_px)[0] for ball in balls]
    directions, sizes, _ = np.linalg.svd(np.column_stack(columns), full_matrices=False)
    return np.asarray(directions[:, sizes > _LEAST_SIZE * sizes[0]], dtype=np.float64)
