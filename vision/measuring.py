"""What one image says about the wires near a view: ridge points where nothing crosses, line ends, the bead's centre."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from vision.bead import BeadEvidence
from vision.contour import Observations, Priors
from vision.devices import Guide
from vision.distortion import PlateFit
from vision.line_ends import LineEnd
from vision.profiles import ProfileReader
from vision.projection import View, project
from vision.refusal import Refusal, RefusalCode
from vision.wire_model import Wire, WireSamples, sample_wires

Array = NDArray[np.float64]

FAINTEST = 0.35  # amplitude of an accepted profile, of the median
_STRONGEST = 3.0  # the same: darker is another thing
_BEAD_SD_PX = 0.15  # of its centre: a spot of some 12 px across on structured ground
_LINE_END_SD_PX = 0.6  # of the place of half absorption, on uneven ground; the ends are there to be judged
_WORST_MISFIT = 0.5  # of its amplitude
_FARTHEST = 0.8  # of the profile's reach: beyond it the crest found is another's
_BALL_MARGIN = 0.8  # of the profile's reach, kept free around a ball
_LEAST_PLACES = 100  # of some 1,300: fewer cannot hold 13 parameters against clutter


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What all candidates of one image share; `balls` (m, 3) corrected pixel and radius, px."""

    guide: Guide
    priors: Priors
    plate: PlateFit
    reader: ProfileReader
    balls: Array


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """One round of measuring.

    Attributes
    ----------
    observations : Observations
        Places that look like a wire's.
    places : WireSamples
        All places where nothing crosses the wire: those that could be measured.
    amplitude : float
        Median absorption of the rings' crests.
    """

    observations: Observations
    places: WireSamples
    amplitude: float


def measure(
    view: View, guide: Guide, scene: Scene, ends: list[LineEnd], bead: BeadEvidence | None
) -> Measured | Refusal:
    """Profiles along all wires where nothing crosses them.

    Parameters
    ----------
    view, guide
        The present estimate, within some pixels.
    scene : Scene
        The image's reader and balls.
    ends, bead
        Single points measured before, if any.

    Returns
    -------
    Measured or Refusal
        `no_guide_found` where hardly a place looks like a wire.
    """
    samples = sample_wires(view, guide)
    places = samples.chosen(_uncrossed(samples, scene))
    if len(places.along) < _LEAST_PLACES:
        return _too_few(len(places.along))
    profiles = scene.reader.read(places.points, places.normals)
    amplitude = float(np.median(profiles.amplitude[places.wire != Wire.LINE]))
    good = (
        (profiles.amplitude > FAINTEST * amplitude)
        & (profiles.amplitude < _STRONGEST * amplitude)
        & (profiles.misfit < _WORST_MISFIT * profiles.amplitude)
        & (np.abs(profiles.offset_px) < _FARTHEST * scene.reader.reach_px)
    )
    if good.sum() < _LEAST_PLACES:
        return _too_few(int(good.sum()))
    chosen = places.chosen(good)
    measured = chosen.points + profiles.offset_px[good, None] * chosen.normals
    single = _single_points(view, guide, ends, bead)
    return Measured(Observations(chosen.wire, chosen.along, measured, chosen.normals, *single), places, amplitude)


def _too_few(count: int) -> Refusal:
    return Refusal(RefusalCode.NO_GUIDE_FOUND, "places that look like a guide's wire", count, _LEAST_PLACES)


def _uncrossed(samples: WireSamples, scene: Scene) -> NDArray[np.bool_]:
    """Which samples no other wire and no ball disturbs."""
    free = np.ones(len(samples.along), dtype=bool)
    for wire in Wire:
        on = samples.wire == wire
        distance, _ = KDTree(samples.points[~on]).query(samples.points[on])
        free[on] = distance > scene.reader.reach_px + 2.0 * scene.reader.crest_sd_px
    if len(scene.balls):
        distance, index = KDTree(scene.balls[:, :2]).query(samples.points)
        free &= distance > scene.balls[index, 2] + _BALL_MARGIN * scene.reader.reach_px
    return free


def _single_points(
    view: View, guide: Guide, ends: list[LineEnd], bead: BeadEvidence | None
) -> tuple[Array, Array, Array, Array]:
    """Line ends along the line, the bead's centre along u and v: places mm, pixels, directions, sd px."""
    rows = [_line_end_row(view, guide, end) for end in ends]
    if bead is not None and guide.bead is not None:
        sd_px = bead_sd_px(view, guide)
        rows += [(*guide.bead.position_mm, *bead.centre_px, *direction, sd_px) for direction in np.eye(2)]
    table = np.array(rows, dtype=np.float64).reshape(-1, 8)
    return table[:, 0:3], table[:, 3:5], table[:, 5:7], table[:, 7]


def _line_end_row(view: View, guide: Guide, end: LineEnd) -> tuple[float, ...]:
    outwards = _outwards(view, guide, end.x_mm)
    place = project(view, np.array([[end.x_mm, 0.0, 0.0]]))[0] + end.excess_px * outwards
    return (end.x_mm, 0.0, 0.0, *place, *outwards, _LINE_END_SD_PX)


def _outwards(view: View, guide: Guide, x_mm: float) -> Array:
    start, end = project(view, np.array([[guide.line_start_mm, 0.0, 0.0], [guide.line_end_mm, 0.0, 0.0]]))
    along = (end - start) / np.linalg.norm(end - start)
    return np.asarray(along if x_mm == guide.line_end_mm else -along)


def bead_sd_px(view: View, guide: Guide) -> float:
    """Standard deviation of the bead's centre: measurement and manufacture, px."""
    if guide.bead is None:
        return _BEAD_SD_PX
    per_mm = view.intrinsics.alpha_x_px / float(view.source_from_guide[2, 3])
    return float(np.hypot(_BEAD_SD_PX, guide.tolerance.bead_sd_mm * per_mm))
