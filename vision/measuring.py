"""What one image says about the wires near a view: their places piece by piece, line ends, the bead's centre."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from vision.bands import Shadows, cut_pieces
from vision.bead_centre import BeadCentre
from vision.devices import Guide
from vision.distortion import PlateFit
from vision.line_ends import LineEnd
from vision.offsets import Offsets, measure_offsets
from vision.priors import Priors
from vision.profiles import ProfileReader
from vision.projection import View, project
from vision.refusal import Refusal, RefusalCode
from vision.view_fit import Observations
from vision.wire_model import Wire, WireSamples, points_in_guide, sample_wires

Array = NDArray[np.float64]

FAINTEST = 0.35  # amplitude of an accepted place, of the median
_STRONGEST = 3.0  # the same: darker is another thing
_WORST_MISFIT = 0.5  # of its amplitude
_FARTHEST = 0.8  # of a profile's reach: beyond it the crest found is another's
_FARTHEST_PIECE = 0.3  # the same for a piece, whose shadow is shifted to the first order only
_BALL_MARGIN = 0.8  # of the profile's reach, kept free around a ball
_LEAST_SHARE = 0.08  # of the wires' places: fewer cannot hold 13 parameters against clutter
_AROUND = 12  # places around each ring, to see whether a view is in the image at all
_LEAST_IN_IMAGE = 0.6  # of them; a view that is nearly right has all
_WIDEST = 3.0  # width of a wire's shadow in reaches of a profile: nearer to the source no guide is looked for
_EVERY = 6  # px along the wires between profiles of the rough measurement


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What all candidates of one image share.

    Attributes
    ----------
    values : NDArray[np.float32]
        Absorption (rows, columns) of the raw image.
    balls : Array
        (m, 3): corrected pixel and radius, px, in the order of the plate's sites.
    blur_px : float
        Standard deviation of the detector's blur.
    """

    guide: Guide
    priors: Priors
    plate: PlateFit
    reader: ProfileReader
    values: NDArray[np.float32]
    balls: Array
    blur_px: float


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """One round of measuring.

    Attributes
    ----------
    observations : Observations
        Places that look like a wire's.
    places : WireSamples
        All places that could be measured: those accepted, and those where nothing crosses the wire.
    amplitude : float
        Median absorption of the rings.
    """

    observations: Observations
    places: WireSamples
    amplitude: float


def find(view: View, guide: Guide, scene: Scene) -> Measured | Refusal:
    """Roughly, from some pixels away: profiles here and there along the wires where nothing crosses them.

    Parameters
    ----------
    view, guide
        The present estimate, within some pixels.
    scene : Scene
        The image's reader and balls.

    Returns
    -------
    Measured or Refusal
        `no_guide_found` where hardly a place looks like a wire, `guide_cut_off` where hardly one is in the image.
    """
    if (away := _ran_away(view, guide, scene)) is not None:
        return away
    everywhere = sample_wires(view, guide)
    samples = everywhere.chosen(np.arange(len(everywhere.along)) % _EVERY == 0)
    places = samples.chosen(_uncrossed(samples, everywhere, scene))
    if len(places.along) < _LEAST_SHARE * len(samples.along):
        return _too_few(len(places.along) / len(samples.along))
    profiles = scene.reader.read(places.points, places.normals)
    nil = np.zeros_like(profiles.offset_px)
    offsets = Offsets(profiles.offset_px, nil, profiles.amplitude, profiles.misfit)
    everything = np.ones(len(places.along), dtype=bool)
    return _accepted(places, everything, offsets, _FARTHEST * scene.reader.reach_px)


def measure(view: View, guide: Guide, scene: Scene, amplitude: float) -> Measured | Refusal:
    """All wires, piece by piece, whatever crosses them.

    Parameters
    ----------
    view, guide
        The present estimate, within a pixel.
    scene : Scene
        The image's absorption and balls.
    amplitude : float
        Absorption of a wire.

    Returns
    -------
    Measured or Refusal
        `no_guide_found` where hardly a place looks like a wire, `guide_cut_off` where hardly one is in the image.
    """
    if (away := _ran_away(view, guide, scene)) is not None:
        return away
    pieces = cut_pieces(view, guide, scene.plate, scene.values, shadows_in(scene, amplitude))
    offsets = measure_offsets(pieces, amplitude, scene.blur_px)
    uncrossed = _uncrossed(pieces.samples, sample_wires(view, guide), scene)
    return _accepted(pieces.samples, uncrossed, offsets, _FARTHEST_PIECE * scene.reader.reach_px)


def _ran_away(view: View, guide: Guide, scene: Scene) -> Refusal | None:
    """Whether a fit to something else has taken the guide out of the image, where nothing can be measured."""
    turn = np.linspace(0.0, 2.0 * np.pi, _AROUND, endpoint=False)
    nearest_mm = guide.wire_diameter_mm * view.intrinsics.alpha_x_px / (_WIDEST * scene.reader.reach_px)
    # half a ring may lie before a source that the other half has passed
    shares = [float(view.source_from_guide[2, 3] > nearest_mm > 0.0)]
    for ring in (Wire.SMALL_RING, Wire.BIG_RING):
        places = points_in_guide(guide, np.full(_AROUND, ring, dtype=np.intp), turn)
        in_front = places @ view.source_from_guide[2, :3] + view.source_from_guide[2, 3] > nearest_mm
        points = project(view, places[in_front])
        shares.append(float(((points >= 0.0) & (points < scene.values.shape[::-1])).all(axis=1).sum()) / _AROUND)
    share = min(shares)
    if share < _LEAST_IN_IMAGE:
        message = "share of a ring of the guide inside the image"
        return Refusal(RefusalCode.GUIDE_CUT_OFF, message, share, _LEAST_IN_IMAGE)
    return None


def _accepted(
    samples: WireSamples,
    uncrossed: NDArray[np.bool_],
    offsets: Offsets,
    farthest_px: float,
) -> Measured | Refusal:
    """The places that look like a wire's, if there are enough."""
    clear = uncrossed & (samples.wire != Wire.LINE)
    if not clear.any():
        return _too_few(0.0)
    amplitude = float(np.median(offsets.amplitude[clear]))
    good = (
        (offsets.amplitude > FAINTEST * amplitude)
        & (offsets.amplitude < _STRONGEST * amplitude)
        & (offsets.misfit < _WORST_MISFIT * offsets.amplitude)
        & (np.abs(offsets.offset_px) < farthest_px)
    )
    if good.mean() < _LEAST_SHARE:
        return _too_few(float(good.mean()))
    chosen = samples.chosen(good)
    measured = chosen.points + offsets.offset_px[good, None] * chosen.normals
    single = np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0)
    observations = Observations(chosen.wire, chosen.along, measured, chosen.normals, offsets.sd_px[good], *single)
    return Measured(observations, samples.chosen(good | uncrossed), amplitude)


def _too_few(share: float) -> Refusal:
    return Refusal(RefusalCode.NO_GUIDE_FOUND, "share of the guide's wires that looks like one", share, _LEAST_SHARE)


def _uncrossed(samples: WireSamples, wires: WireSamples, scene: Scene) -> NDArray[np.bool_]:
    """Which samples no other wire and no ball disturbs."""
    free = np.ones(len(samples.along), dtype=bool)
    clear_px = scene.reader.reach_px + 2.0 * scene.reader.crest_sd_px
    for wire in Wire:
        on = samples.wire == wire
        others = KDTree(wires.points[wires.wire != wire], balanced_tree=False, compact_nodes=False)  # sooner built
        distance, _ = others.query(samples.points[on], distance_upper_bound=clear_px)
        free[on] = distance > clear_px
    if len(scene.balls):
        clear_px = float(scene.balls[:, 2].max()) + _BALL_MARGIN * scene.reader.reach_px
        distance, _ = KDTree(scene.balls[:, :2]).query(samples.points, distance_upper_bound=clear_px)
        free &= distance > clear_px
    return free


def with_single_points(
    observations: Observations, view: View, guide: Guide, ends: list[LineEnd], bead: BeadCentre | None
) -> Observations:
    """The places on the wires, and beside them line ends along the line, the bead's centre along u and v."""
    rows = [_line_end_row(view, guide, end) for end in ends]
    if bead is not None and guide.bead is not None:
        sd_px = bead_sd_px(view, guide, bead)
        rows += [(*guide.bead.position_mm, *bead.centre_px, *direction, sd_px) for direction in np.eye(2)]
    table = np.array(rows, dtype=np.float64).reshape(-1, 8)
    return replace(
        observations,
        extra_in_guide=table[:, 0:3],
        extra_measured=table[:, 3:5],
        extra_normals=table[:, 5:7],
        extra_sd_px=table[:, 7],
    )


def _line_end_row(view: View, guide: Guide, end: LineEnd) -> tuple[float, ...]:
    """Place in the guide, mm; corrected pixel; direction; standard deviation, px."""
    outwards = _outwards(view, guide, end.x_mm)
    place = project(view, np.array([[end.x_mm, 0.0, 0.0]]))[0] + end.excess_px * outwards
    return (end.x_mm, 0.0, 0.0, *place, *outwards, end.sd_px)


def _outwards(view: View, guide: Guide, x_mm: float) -> Array:
    start, end = project(view, np.array([[guide.line_start_mm, 0.0, 0.0], [guide.line_end_mm, 0.0, 0.0]]))
    along = (end - start) / np.linalg.norm(end - start)
    return np.asarray(along if x_mm == guide.line_end_mm else -along)


def bead_sd_px(view: View, guide: Guide, bead: BeadCentre) -> float:
    """Standard deviation of the bead's centre: measurement and manufacture, px."""
    per_mm = view.intrinsics.alpha_x_px / float(view.source_from_guide[2, 3])
    return float(np.hypot(bead.sd_px, guide.tolerance.bead_sd_mm * per_mm))


def shadows_in(scene: Scene, amplitude: float) -> Shadows:
    """What wires and balls look like in an image whose wires absorb so much."""
    ball_radius_px = float(scene.balls[0, 2]) if len(scene.balls) else 0.0
    return Shadows(amplitude, scene.blur_px, scene.plate.sites, ball_radius_px)
